#include "drives/families.hpp"

#include "drives/cubemars/cubemars_family.hpp"
#include "drives/cubemars/cubemars_recogniser.hpp"
#include "drives/cubemars/cubemars_simulated.hpp"
#include "drives/damiao/damiao_motor.hpp"
#include "drives/damiao/damiao_recogniser.hpp"
#include "drives/damiao/damiao_simulated.hpp"
#include "drives/dji/dji_family.hpp"
#include "drives/dji/dji_recogniser.hpp"
#include "drives/dji/dji_simulated.hpp"
#include "drives/lktech/lktech_motor.hpp"
#include "drives/lktech/lktech_recogniser.hpp"
#include "drives/lktech/lktech_simulated.hpp"
#include "drives/moteus/moteus_model.hpp"
#include "drives/moteus/moteus_recogniser.hpp"
#include "drives/moteus/moteus_simulated.hpp"
#include "drives/myactuator/myactuator_motor.hpp"
#include "drives/myactuator/myactuator_recogniser.hpp"
#include "drives/myactuator/myactuator_simulated.hpp"
#include "drives/odrive/odrive_motor.hpp"
#include "drives/odrive/odrive_recogniser.hpp"
#include "drives/odrive/odrive_simulated.hpp"
#include "drives/robstride/robstride_motor.hpp"
#include "drives/robstride/robstride_recogniser.hpp"
#include "drives/robstride/robstride_simulated.hpp"
#include "drives/vesc/vesc_motor.hpp"
#include "drives/vesc/vesc_recogniser.hpp"
#include "drives/vesc/vesc_simulated.hpp"

namespace rc10 {

std::vector<FamilyEntry> builtInFamilies() {
  return {
      {&djiFamily(), sim::makeDjiDrive, recogniseDji},
      {&vescFamily(), sim::makeVescDrive, recogniseVesc},
      {&damiaoFamily(), sim::makeDamiaoDrive, recogniseDamiao},
      {&robStrideFamily(), sim::makeRobStrideDrive, recogniseRobStride},
      {&cubemarsFamily(), sim::makeCubemarsDrive, recogniseCubemars},
      {&moteusFamily(), sim::makeMoteusDrive, recogniseMoteus},
      {&odriveFamily(), sim::makeOdriveDrive, recogniseOdrive},
      {&myactuatorFamily(), sim::makeMyactuatorDrive, recogniseMyactuator},
      {&lktechFamily(), sim::makeLktechDrive, recogniseLktech},
  };
}

}  // namespace rc10
