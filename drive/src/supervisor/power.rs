//! Checks of the bus voltage and of the power stage's temperature.

use super::Found;
use crate::current::CurrentReport;
use crate::hardware::Hardware;
use crate::thermistor::Thermistor;
use crate::units::{clamp_i32, milli, narrow, quotient};
use crate::{Celsius, Volts};
use touchstone_control::Si;
use touchstone_protocol::DeviceSettings;
use touchstone_protocol::FaultCode;

/// Limits of the power stage's bus voltage and temperature.
#[derive(Debug, Clone, Copy)]
pub struct PowerConfig {
    bus_min: Volts,
    bus_max: Volts,
    thermistor: Thermistor,
    #[cfg(feature = "voltage")]
    is_without_sensor: bool,
    fault_from: Celsius,
    /// Reduction of the current limit per degree above the temperature at which derating begins, as a fraction of the limit in
    /// 1/65,536.
    share_per_degree: i32,
}

impl PowerConfig {
    /// Computes the limits of bus voltage and temperature from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings, hardware: &Hardware) -> Self {
        let limits = &settings.limits;
        let span = limits
            .fault_from_celsius
            .saturating_sub(limits.derate_from_celsius);
        Self {
            bus_min: narrow(limits.bus_min_v),
            bus_max: narrow(limits.bus_max_v),
            thermistor: hardware.thermistor,
            #[cfg(feature = "voltage")]
            is_without_sensor: hardware.thermistor == Thermistor::NONE,
            fault_from: narrow(limits.fault_from_celsius),
            share_per_degree: narrow(quotient(Si::ONE, span)).to_bits(),
        }
    }
}

impl PowerConfig {
    /// Whether this bus voltage is within the limits for the power stage.
    #[cfg(feature = "large")]
    #[must_use]
    pub fn takes(&self, bus: Volts) -> bool {
        (self.bus_min..=self.bus_max).contains(&bus)
    }
}

/// The check of the power stage, which has no memory.
#[derive(Debug, Clone, Copy)]
pub struct Power;

impl Power {
    /// The temperature of the power stage; `None` if the sensor's reading is impossible.
    #[must_use]
    pub fn temperature(thermistor: &Thermistor, report: &CurrentReport) -> Option<Celsius> {
        thermistor.celsius(report.temperature)
    }

    /// Returns the fault, if there is one, and the fraction of the current limit that the temperature allows, in 1/65,536. The
    /// whole limit is allowed up to the temperature at which derating begins, nothing at the temperature of the fault, with a
    /// straight line between.
    #[must_use]
    pub fn inspect(config: &PowerConfig, report: &CurrentReport) -> (Option<Found>, u32) {
        let temperature = Self::temperature(&config.thermistor, report);
        let left = temperature.map_or(0, |celsius| {
            let below = i64::from(config.fault_from.saturating_sub(celsius).to_bits());
            clamp_i32((below * i64::from(config.share_per_degree)) >> 16).clamp(0, 1 << 16)
        });
        #[cfg(feature = "voltage")]
        let left = if config.is_without_sensor {
            1 << 16
        } else {
            left
        };
        let fault = if report.bus > config.bus_max {
            Some((FaultCode::OverVoltage, milli(report.bus)))
        } else if report.bus < config.bus_min {
            Some((FaultCode::UnderVoltage, milli(report.bus)))
        } else {
            match temperature {
                // The board has no temperature sensor; its driver protects itself.
                #[cfg(feature = "voltage")]
                None if config.is_without_sensor => None,
                Some(celsius) if celsius < config.fault_from => None,
                Some(celsius) => Some((FaultCode::OverTemperature, milli(celsius) / 100)),
                None => Some((FaultCode::OverTemperature, i32::MAX)),
            }
        };
        (fault, left.unsigned_abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hardware::IHM08M1;

    fn report(bus: f64, code: u16) -> CurrentReport {
        CurrentReport {
            bus: Volts::from_num(bus),
            temperature: code,
            ..CurrentReport::default()
        }
    }

    #[test]
    fn derating_falls_from_all_to_nothing_where_the_fault_is() {
        let config = PowerConfig::new(&DeviceSettings::default(), &IHM08M1);
        let mut last = 1 << 16;
        let mut seen = [false; 3];
        for code in 1_140..3_700 {
            let (fault, left) = Power::inspect(&config, &report(24.0, code));
            let celsius: f64 = IHM08M1.thermistor.celsius(code).unwrap().to_num();
            let exact = ((90.0 - celsius) / 20.0).clamp(0.0, 1.0);
            assert!(
                (f64::from(left) / 65_536.0 - exact).abs() < 1e-3,
                "{celsius}: {left}"
            );
            assert!(left <= last);
            assert_eq!(fault.is_some(), celsius >= 90.0, "{celsius}");
            seen[usize::from(left < 1 << 16) + usize::from(left == 0)] = true;
            last = left;
        }
        assert_eq!(seen, [true; 3]);
    }

    #[test]
    fn each_limit_has_its_code_and_value() {
        let config = PowerConfig::new(&DeviceSettings::default(), &IHM08M1);
        let code = |bus, code| Power::inspect(&config, &report(bus, code)).0;
        assert_eq!(code(24.0, 1_300), None);
        assert_eq!(code(31.5, 1_300), Some((FaultCode::OverVoltage, 31_500)));
        assert_eq!(code(17.5, 1_300), Some((FaultCode::UnderVoltage, 17_500)));
        assert_eq!(code(24.0, 0), Some((FaultCode::OverTemperature, i32::MAX)));
        let (fault, value) = code(24.0, 3_393).unwrap();
        assert_eq!((fault, value), (FaultCode::OverTemperature, 1_000));
        // With a broken sensor no current is allowed either.
        assert_eq!(Power::inspect(&config, &report(24.0, 4_095)).1, 0);
    }
}
