#include "drives/families.hpp"

#include "drives/cubemars/cubemars_family.hpp"
#include "drives/cubemars/cubemars_simulated.hpp"
#include "drives/damiao/damiao_motor.hpp"
#include "drives/damiao/damiao_simulated.hpp"
#include "drives/dji/dji_family.hpp"
#include "drives/dji/dji_simulated.hpp"
#include "drives/lktech/lktech_motor.hpp"
#include "drives/lktech/lktech_simulated.hpp"
#include "drives/moteus/moteus_model.hpp"
#include "drives/moteus/moteus_simulated.hpp"
#include "drives/myactuator/myactuator_motor.hpp"
#include "drives/myactuator/myactuator_simulated.hpp"
#include "drives/odrive/odrive_motor.hpp"
#include "drives/odrive/odrive_simulated.hpp"
#include "drives/robstride/robstride_motor.hpp"
#include "drives/robstride/robstride_simulated.hpp"
#include "drives/vesc/vesc_motor.hpp"
#include "drives/vesc/vesc_simulated.hpp"

namespace rc10 {

std::vector<FamilyEntry> builtInFamilies() {
  return {
      {&djiFamily(), sim::makeDjiDrive},           {&vescFamily(), sim::makeVescDrive},
      {&damiaoFamily(), sim::makeDamiaoDrive},     {&robStrideFamily(), sim::makeRobStrideDrive},
      {&cubemarsFamily(), sim::makeCubemarsDrive}, {&moteusFamily(), sim::makeMoteusDrive},
      {&odriveFamily(), sim::makeOdriveDrive},     {&myactuatorFamily(), sim::makeMyactuatorDrive},
      {&lktechFamily(), sim::makeLktechDrive},
  };
}

}  // namespace rc10
