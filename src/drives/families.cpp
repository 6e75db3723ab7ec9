#include "drives/families.hpp"

#include <array>

#include "drives/cubemars/cubemars_family.hpp"
#include "drives/cubemars/cubemars_recogniser.hpp"
#include "drives/cubemars/cubemars_simulated.hpp"
#include "drives/cubemars/cubemars_wording.hpp"
#include "drives/damiao/damiao_family.hpp"
#include "drives/damiao/damiao_recogniser.hpp"
#include "drives/damiao/damiao_simulated.hpp"
#include "drives/damiao/damiao_wording.hpp"
#include "drives/dji/dji_family.hpp"
#include "drives/dji/dji_recogniser.hpp"
#include "drives/dji/dji_simulated.hpp"
#include "drives/dji/dji_wording.hpp"
#include "drives/lktech/lktech_family.hpp"
#include "drives/lktech/lktech_recogniser.hpp"
#include "drives/lktech/lktech_simulated.hpp"
#include "drives/lktech/lktech_wording.hpp"
#include "drives/moteus/moteus_family.hpp"
#include "drives/moteus/moteus_recogniser.hpp"
#include "drives/moteus/moteus_simulated.hpp"
#include "drives/moteus/moteus_wording.hpp"
#include "drives/myactuator/myactuator_family.hpp"
#include "drives/myactuator/myactuator_recogniser.hpp"
#include "drives/myactuator/myactuator_simulated.hpp"
#include "drives/myactuator/myactuator_wording.hpp"
#include "drives/odrive/odrive_family.hpp"
#include "drives/odrive/odrive_recogniser.hpp"
#include "drives/odrive/odrive_simulated.hpp"
#include "drives/odrive/odrive_wording.hpp"
#include "drives/robstride/robstride_family.hpp"
#include "drives/robstride/robstride_recogniser.hpp"
#include "drives/robstride/robstride_simulated.hpp"
#include "drives/robstride/robstride_wording.hpp"
#include "drives/vesc/vesc_family.hpp"
#include "drives/vesc/vesc_recogniser.hpp"
#include "drives/vesc/vesc_simulated.hpp"
#include "drives/vesc/vesc_wording.hpp"

namespace rc10 {

std::span<const FamilyEntry> builtInFamilies() {
  static const std::array kFamilies{
      FamilyEntry{
          .family = &djiFamily(), .simulate = sim::makeDjiDrive, .recognise = recogniseDji, .word = wordDji},
      FamilyEntry{.family = &vescFamily(),
                  .simulate = sim::makeVescDrive,
                  .recognise = recogniseVesc,
                  .word = wordVesc,
                  .questions = &vescQuestions()},
      FamilyEntry{.family = &damiaoFamily(),
                  .simulate = sim::makeDamiaoDrive,
                  .recognise = recogniseDamiao,
                  .word = wordDamiao,
                  .only_answer = damiaoFamily().name(),
                  .speaks = speaksDamiao},
      FamilyEntry{.family = &robstrideFamily(),
                  .simulate = sim::makeRobstrideDrive,
                  .recognise = recogniseRobstride,
                  .word = wordRobstride,
                  .questions = &robstrideQuestions()},
      FamilyEntry{.family = &cubemarsFamily(),
                  .simulate = sim::makeCubemarsDrive,
                  .recognise = recogniseCubemars,
                  .word = wordCubemars,
                  .only_answer = drive_kind::kCubemarsMit},
      FamilyEntry{.family = &moteusFamily(),
                  .simulate = sim::makeMoteusDrive,
                  .recognise = recogniseMoteus,
                  .word = wordMoteus,
                  .only_answer = moteusFamily().name()},
      FamilyEntry{.family = &odriveFamily(),
                  .simulate = sim::makeOdriveDrive,
                  .recognise = recogniseOdrive,
                  .word = wordOdrive,
                  .obeyed_by = odriveObeying},
      FamilyEntry{.family = &myactuatorFamily(),
                  .simulate = sim::makeMyactuatorDrive,
                  .recognise = recogniseMyactuator,
                  .word = wordMyactuator,
                  .only_answer = myactuatorFamily().name()},
      FamilyEntry{.family = &lktechFamily(),
                  .simulate = sim::makeLktechDrive,
                  .recognise = recogniseLktech,
                  .word = wordLktech,
                  .only_answer = lktechFamily().name()},
  };
  return kFamilies;
}

}  // namespace rc10
