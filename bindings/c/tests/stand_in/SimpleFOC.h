/* Declarations of the parts of SimpleFOC 2.3 that the example uses, to compile it without the library. */
#pragma once
#include "Arduino.h"
struct MagneticSensorSPIConfig_s {};
extern MagneticSensorSPIConfig_s AS5048_SPI;
class Sensor {};
class MagneticSensorSPI : public Sensor {
public:
  MagneticSensorSPI(MagneticSensorSPIConfig_s config, int cs);
  void init(void *spi = nullptr);
  float getAngle();
};
class BLDCDriver3PWM {
public:
  BLDCDriver3PWM(int a, int b, int c, int enable);
  float voltage_power_supply;
  int init();
};
enum MotionControlType : uint8_t { torque };
enum TorqueControlType : uint8_t { voltage };
enum Direction : int8_t { CW = 1, CCW = -1, UNKNOWN = 0 };
class BLDCMotor {
public:
  BLDCMotor(int pole_pairs);
  Direction sensor_direction = Direction::UNKNOWN;
  MotionControlType controller;
  TorqueControlType torque_controller;
  float voltage_limit;
  void linkSensor(Sensor *sensor);
  void linkDriver(BLDCDriver3PWM *driver);
  int init();
  int initFOC();
  void loopFOC();
  void move(float target);
  void disable();
};
