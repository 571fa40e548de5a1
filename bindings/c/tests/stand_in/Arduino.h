/* Declarations of the parts of Arduino that the examples use, to compile them without it. */
#pragma once
#include <stdint.h>
enum { LOW, HIGH, INPUT = 0, OUTPUT, INPUT_PULLUP, CHANGE = 1 };
struct Printer {
  void begin(unsigned long baud);
  void println(const char *text);
};
extern Printer Serial;
unsigned long micros();
void pinMode(int pin, int mode);
int digitalRead(int pin);
void digitalWrite(int pin, int value);
void analogWrite(int pin, int value);
int digitalPinToInterrupt(int pin);
void attachInterrupt(int interrupt, void (*call)(), int mode);
