//! Chooses a haptic device and opens it.

use clap::ValueEnum;
use std::path::PathBuf;
use std::sync::Arc;
use touchstone_device::haptic::{
    FALCON_RATE_HZ, HapticDevice, HapticFault, Rest, SimulatedArm, SimulatedDelta,
};
use touchstone_device::{Inverse3, Omega3, SERVICE, Survey};
use touchstone_dhd::{Dhd, LibrarySearch};
use touchstone_lab::scorecard::in_turn::DeedsInTurn;
use touchstone_lab::thesis::space::{Object, ProbingMotion, SLIDE_MM_PER_S};
use touchstone_sim::error::{Error, Result};
use touchstone_world::plant::{FIRM_TRANSLATION, Hand, OMEGA3};

/// A type of haptic device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HapticKind {
    /// Force Dimension's omega.3, through its maker's library.
    Omega3,
    /// Haply's Inverse3, through its maker's service.
    Inverse3,
    /// An omega.3 with its published limits, or a device from a survey, in a simulated hand.
    Simulated,
    /// A delta mechanism with the Falcon's geometry, in a simulated hand.
    SimulatedDelta,
}

impl HapticKind {
    /// The name of this type of device on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Omega3 => "omega3",
            Self::Inverse3 => "inverse3",
            Self::Simulated => "simulated",
            Self::SimulatedDelta => "simulated-delta",
        }
    }

    /// Whether this program simulates the device, so that the run may be faster than real time.
    pub fn is_simulated(self) -> bool {
        matches!(self, Self::Simulated | Self::SimulatedDelta)
    }

    /// Default control rate of a simulated device, Hz.
    pub fn own_rate_hz(self) -> u32 {
        match self {
            Self::SimulatedDelta => FALCON_RATE_HZ,
            _ => OMEGA3.rates_hz.1,
        }
    }
}

/// The options that choose a haptic device.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct WhichDevice {
    /// The haptic device; without it, the first real one that is connected.
    #[arg(long, value_enum)]
    device: Option<HapticKind>,
    /// Force Dimension's library, libdrd or libdhd; without it, the usual places are searched (docs/devices.md).
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
    /// Address at which Haply's service listens.
    #[arg(long, value_name = "HOST:PORT")]
    haply: Option<String>,
    /// Simulates the device of a survey (`touchstone device survey --out FILE`).
    #[arg(long, value_name = "FILE.toml")]
    twin: Option<PathBuf>,
}

/// Name of Force Dimension's library in error messages.
const LIBRARY: &str = "Force Dimension's library";

/// Loads Force Dimension's library; the error says how to install it.
pub fn library(file: Option<&std::path::Path>) -> Result<Dhd> {
    LibrarySearch::new(file)
        .load()
        .map_err(|missing| Error::device(LIBRARY, missing.to_string(), missing.fix()))
}

/// Description of the library for users.
pub fn described(library: &Dhd) -> String {
    let version = library
        .version()
        .unwrap_or_else(|| "of unknown version".into());
    format!("library {version}, {}", library.path().display())
}

/// Motion of a simulated hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SimulatedHand {
    /// No hand; the device runs at this control rate, Hz.
    Nobody(u32),
    /// For a device that is only opened to read its properties: the hand moves as at a floor, at 1 kHz.
    Still,
    /// The hand moves around an object repeatedly, at this control rate, Hz.
    Moves(Object, u32),
    /// The hand goes to an object's surface, and does the scorecard's actions there one after the other.
    InTurn(Object, DeedsInTurn),
}

impl SimulatedHand {
    /// Mass, stiffness and damping of the simulated hand; `None` without a hand.
    fn hand(self) -> Option<Hand> {
        match self {
            Self::Nobody(_) => None,
            Self::InTurn(_, turn) => Some(turn.hand),
            Self::Still | Self::Moves(..) => Some(FIRM_TRANSLATION),
        }
    }
}

/// The rest point of a simulated hand over time, and its update rate, Hz. A hand that slides along the object does so at
/// `slide_mm_per_s`.
fn rest(hand: SimulatedHand, slide_mm_per_s: f64) -> (Rest, u32) {
    let (object, rate_hz) = match hand {
        SimulatedHand::Nobody(rate_hz) => return (Box::new(|_| [0.0; 3]), rate_hz),
        SimulatedHand::InTurn(object, turn) => {
            let rate_hz = turn.approach.rate_hz;
            let rest = move |time_s: f64| {
                let tick = (time_s * f64::from(rate_hz)).round() as u64;
                object.at_depth_m(turn.rest_depth_m(tick))
            };
            return (Box::new(rest), rate_hz);
        }
        SimulatedHand::Still => (Object::Horizontal, 1000),
        SimulatedHand::Moves(object, rate_hz) => (object, rate_hz),
    };
    let motion = ProbingMotion::of(object).at_speed(slide_mm_per_s);
    let rest = move |time_s: f64| {
        let whole_s = f64::from(motion.ticks()) * 1e-3;
        motion.rest_mm(time_s % whole_s).map(|x| x * 1e-3)
    };
    (Box::new(rest), rate_hz)
}

fn delta(hand: SimulatedHand) -> Result<SimulatedDelta> {
    // This device's workspace is 80 mm wide, that of the omega.3 160 mm, so the hand slides more slowly here.
    let (rest, rate_hz) = rest(hand, 20.0);
    let at = hand.hand();
    SimulatedDelta::falcon(at.as_ref(), rate_hz, rest).map_err(|fault| fault.at("simulated-delta"))
}

impl WhichDevice {
    /// The type of device that an option names; `None` if no option names one.
    pub fn model(&self) -> Option<HapticKind> {
        // `--twin` implies the simulated device, and `--haply` implies the Inverse3, the only device with such a service.
        let service = self.haply.as_ref().map(|_| HapticKind::Inverse3);
        let twin = self.twin.as_ref().map(|_| HapticKind::Simulated);
        self.device.or(twin).or(service)
    }

    /// Refuses a survey or a service address for a device that uses none, instead of ignoring it.
    pub fn check(&self) -> Result<()> {
        let lost = |option: &str, only: HapticKind| Error::Option {
            option: option.into(),
            problem: format!("is for {} only", only.word()),
            fix: format!("leave it out, or give --device {}", only.word()),
        };
        match self.model() {
            Some(HapticKind::Inverse3 | HapticKind::Omega3 | HapticKind::SimulatedDelta)
                if self.twin.is_some() =>
            {
                Err(lost("--twin", HapticKind::Simulated))
            }
            Some(HapticKind::Simulated | HapticKind::Omega3 | HapticKind::SimulatedDelta)
                if self.haply.is_some() =>
            {
                Err(lost("--haply", HapticKind::Inverse3))
            }
            _ => Ok(()),
        }
    }

    /// All types of devices, each with a description of the device found, or the reason why none was found.
    pub fn all(&self) -> Vec<(HapticKind, Result<String>)> {
        let wanted = |model: &&HapticKind| self.model().is_none_or(|only| only == **model);
        let models = [
            HapticKind::Omega3,
            HapticKind::Inverse3,
            HapticKind::Simulated,
            HapticKind::SimulatedDelta,
        ];
        let models = models.iter().filter(wanted);
        models
            .map(|model| {
                let found = match model {
                    HapticKind::Omega3 => self.omega3().map(|(omega, library)| {
                        format!("{}; {}", omega.sheet().name, described(&library))
                    }),
                    HapticKind::Inverse3 => {
                        self.inverse3().map(|inverse| inverse.sheet().name.clone())
                    }
                    HapticKind::Simulated => self
                        .simulated(SimulatedHand::Still)
                        .map(|arm| arm.sheet().name.clone()),
                    HapticKind::SimulatedDelta => {
                        delta(SimulatedHand::Still).map(|delta| delta.sheet().name.clone())
                    }
                };
                (*model, found)
            })
            .collect()
    }

    /// Opens the chosen device, with its motors off.
    pub fn open(&self, hand: SimulatedHand) -> Result<Box<dyn HapticDevice>> {
        self.check()?;
        match self.model() {
            Some(HapticKind::Simulated) => Ok(Box::new(self.simulated(hand)?)),
            Some(HapticKind::SimulatedDelta) => Ok(Box::new(delta(hand)?)),
            Some(HapticKind::Omega3) => Ok(Box::new(self.omega3()?.0)),
            Some(HapticKind::Inverse3) => Ok(Box::new(self.inverse3()?)),
            None => self.first(),
        }
    }

    /// Opens the first real device: the omega.3 if its library is installed, else the Inverse3 if its service runs. If the service
    /// runs but the Inverse3 cannot be used, the error is the Inverse3's: its user does not need the omega.3's library.
    fn first(&self) -> Result<Box<dyn HapticDevice>> {
        let missing = match self.omega3() {
            Ok((omega, _)) => return Ok(Box::new(omega)),
            Err(missing) => missing,
        };
        match (Inverse3::connect(self.service()), missing) {
            (Ok(inverse), _) => Ok(Box::new(inverse)),
            (
                Err(HapticFault::NoService(_)),
                Error::Device {
                    place,
                    problem,
                    fix,
                },
            ) => Err(Error::Device {
                place,
                problem: format!("{problem}; nor is there a service of an Inverse3"),
                fix: format!("{fix}; without a device: --device simulated"),
            }),
            (Err(HapticFault::NoService(_)), other) => Err(other),
            (Err(fault), _) => Err(fault.at("Inverse3")),
        }
    }

    /// Address of the Inverse3's service.
    fn service(&self) -> &str {
        self.haply.as_deref().unwrap_or(SERVICE)
    }

    fn inverse3(&self) -> Result<Inverse3> {
        Inverse3::connect(self.service()).map_err(|fault| fault.at("Inverse3"))
    }

    /// Opens the omega.3, with its motors off.
    pub fn omega3(&self) -> Result<(Omega3, Arc<Dhd>)> {
        let library = Arc::new(library(self.library.as_deref())?);
        let omega = Omega3::open(Arc::clone(&library)).map_err(|fault| fault.at("omega.3"))?;
        Ok((omega, library))
    }

    fn simulated(&self, hand: SimulatedHand) -> Result<SimulatedArm> {
        let (twin, name) = match &self.twin {
            None => (touchstone_device::haptic::DeviceTwin::default(), None),
            Some(file) => {
                let survey = Survey::read(file)?;
                (survey.twin()?, Some(format!("simulated {}", survey.device)))
            }
        };
        let (rest, rate_hz) = rest(hand, SLIDE_MM_PER_S);
        let twin = touchstone_device::haptic::DeviceTwin {
            hand: hand.hand(),
            ..twin
        };
        let arm = SimulatedArm::new(twin, rate_hz, rest).map_err(|fault| fault.at("simulated"))?;
        Ok(match name {
            Some(name) => arm.named(name),
            None => arm,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Read, Write};
    use std::net::TcpListener;

    /// The error without a library of the omega.3, with this address of the Inverse3's service.
    fn said(service: String) -> String {
        let which = WhichDevice {
            library: Some("/nowhere/libdrd.so".into()),
            haply: Some(service),
            ..WhichDevice::default()
        };
        which.first().err().expect("no device").to_string()
    }

    #[test]
    fn an_inverse3_that_cannot_be_used_says_why_itself() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let service = listener.local_addr().expect("bound").to_string();
        let server = std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().expect("the program connects");
            let _ = stream.read(&mut [0; 1024]);
            let _ = stream.write_all(b"HTTP/1.1 200 OK\r\n\r\n{\"version\":\"2.1.0\"}");
        });
        let present = said(service.clone());
        server.join().expect("it answered");
        assert!(present.contains("only 3 is known"), "{present}");
        assert!(!present.contains("libdrd"), "{present}");
        // The listener is gone, so nothing answers at this address any more.
        let absent = said(service);
        assert!(absent.contains("/nowhere/libdrd.so"), "{absent}");
        assert!(absent.contains("nor is there a service"), "{absent}");
    }
}
