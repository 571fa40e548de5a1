//! A simulated debug probe in front of a [`Machine`] (simulated microcontroller). It has the debug port and the memory access port
//! of Arm's specification ADIv5 (IHI 0031), as a CMSIS-DAP probe reaches them.

use std::fmt;
use std::sync::{Arc, Mutex};

use probe_rs::CoreStatus;
use probe_rs::architecture::arm::sequences::ArmDebugSequence;
use probe_rs::architecture::arm::{
    ArmCommunicationInterface, ArmDebugInterface, ArmError, DapError, DapProbe, RawDapAccess,
    RegisterAddress,
};
use probe_rs::probe::{DebugProbe, DebugProbeError, WireProtocol};

use crate::machine::Machine;

/// Addresses of the registers of the debug port (ADIv5).
const DPIDR_OR_ABORT: u8 = 0x0;
const CTRL_STAT: u8 = 0x4;
const SELECT: u8 = 0x8;
const POWER: u32 = 1 << 28 | 1 << 30;
const STICKY_ERROR: u32 = 1 << 5;
const CLEAR_STICKY_ERROR: u32 = 1 << 2;
/// Addresses of the registers of access port 0 (ADIv5), which reads and writes the chip's memory.
const CSW: u32 = 0x00;
const TAR: u32 = 0x04;
const DRW: u32 = 0x0c;
const BANKED_DATA: u32 = 0x10;
const BASE: u32 = 0xf8;
const IDR: u32 = 0xfc;

/// A simulated debug probe.
pub struct SoftProbe {
    machine: Arc<Mutex<Machine>>,
    /// Whether a chip answers on the wires of the probe.
    answers: bool,
    select: u32,
    control: u32,
    csw: u32,
    tar: u32,
}

impl fmt::Debug for SoftProbe {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("SoftProbe")
    }
}

impl SoftProbe {
    /// A simulated debug probe that is wired to the microcontroller `machine`.
    pub fn new(machine: Arc<Mutex<Machine>>, answers: bool) -> Self {
        Self {
            machine,
            answers,
            select: 0,
            control: 0,
            csw: 0x0300_0042,
            tar: 0,
        }
    }

    fn fault(&mut self) -> ArmError {
        self.control |= STICKY_ERROR;
        ArmError::Dap(DapError::FaultResponse)
    }

    /// Address and size in bytes of the next memory transfer. Then advances the address register within 1 KiB, if the probe has
    /// enabled this.
    fn transfer(&mut self, register: u32) -> Option<(u32, u32)> {
        if register != DRW {
            return Some((self.tar & !0xf | register & 0xc, 4));
        }
        let bytes = 1 << (self.csw & 7);
        let address = self.tar;
        if self.csw >> 4 & 3 == 1 {
            self.tar = address & !0x3ff | (address + bytes) & 0x3ff;
        }
        (bytes <= 4).then_some((address, bytes))
    }

    fn access_read(&mut self, register: u32) -> Result<u32, ArmError> {
        if self.select >> 24 != 0 {
            // There is no other access port.
            return Ok(0);
        }
        Ok(match register {
            CSW => self.csw | 0x40,
            TAR => self.tar,
            BASE => 0xe00f_f003,
            IDR => 0x2477_0011,
            DRW | BANKED_DATA..0x20 => {
                let whole = self
                    .transfer(register)
                    .filter(|_| self.control & STICKY_ERROR == 0);
                let Some((address, bytes)) = whole else {
                    return Err(self.fault());
                };
                let value = self.machine.lock().unwrap().load(address, bytes);
                match value {
                    // ADIv5 returns a byte or half-word at its place in the 32-bit word that contains the address.
                    Some(value) => value << (address % 4 * 8),
                    None => return Err(self.fault()),
                }
            }
            _ => 0,
        })
    }

    fn access_write(&mut self, register: u32, value: u32) -> Result<(), ArmError> {
        match register {
            _ if self.select >> 24 != 0 => {}
            CSW => self.csw = value,
            TAR => self.tar = value,
            DRW | BANKED_DATA..0x20 => {
                let whole = self
                    .transfer(register)
                    .filter(|_| self.control & STICKY_ERROR == 0);
                let Some((address, bytes)) = whole else {
                    return Err(self.fault());
                };
                let value = value >> (address % 4 * 8);
                let stored = self.machine.lock().unwrap().store(address, bytes, value);
                if stored.is_none() {
                    return Err(self.fault());
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn bank(&self, register: u8) -> u32 {
        self.select & 0xf0 | u32::from(register & 0xf)
    }
}

impl RawDapAccess for SoftProbe {
    fn raw_read_register(&mut self, address: RegisterAddress) -> Result<u32, ArmError> {
        if !self.answers {
            return Err(ArmError::Dap(DapError::NoAcknowledge));
        }
        match address {
            RegisterAddress::ApRegister(register) => self.access_read(self.bank(register)),
            RegisterAddress::DpRegister(register) => Ok(match register.address {
                DPIDR_OR_ABORT => 0x2ba0_1477,
                // Every power-up request is acknowledged at once.
                CTRL_STAT if self.select & 0xf == 0 => self.control | (self.control & POWER) << 1,
                _ => 0,
            }),
        }
    }

    fn raw_write_register(&mut self, address: RegisterAddress, value: u32) -> Result<(), ArmError> {
        if !self.answers {
            return Err(ArmError::Dap(DapError::NoAcknowledge));
        }
        match address {
            RegisterAddress::ApRegister(register) => {
                self.access_write(self.bank(register), value)?
            }
            RegisterAddress::DpRegister(register) => match register.address {
                DPIDR_OR_ABORT if value & CLEAR_STICKY_ERROR != 0 => self.control &= !STICKY_ERROR,
                CTRL_STAT if self.select & 0xf == 0 => {
                    self.control = value & POWER | self.control & STICKY_ERROR;
                }
                SELECT => self.select = value,
                _ => {}
            },
        }
        Ok(())
    }

    fn jtag_sequence(&mut self, _: u8, _: bool, _: u64) -> Result<(), DebugProbeError> {
        Err(DebugProbeError::UnsupportedProtocol(WireProtocol::Jtag))
    }

    fn swj_sequence(&mut self, _: u8, _: u64) -> Result<(), DebugProbeError> {
        Ok(())
    }

    fn swj_pins(&mut self, _: u32, _: u32, _: u32) -> Result<u32, DebugProbeError> {
        Ok(0)
    }

    fn into_probe(self: Box<Self>) -> Box<dyn DebugProbe> {
        self
    }

    fn core_status_notification(&mut self, _: CoreStatus) -> Result<(), DebugProbeError> {
        Ok(())
    }
}

impl DapProbe for SoftProbe {}

impl DebugProbe for SoftProbe {
    fn get_name(&self) -> &str {
        "probe in software"
    }

    fn speed_khz(&self) -> u32 {
        1000
    }

    fn set_speed(&mut self, speed_khz: u32) -> Result<u32, DebugProbeError> {
        Ok(speed_khz)
    }

    fn attach(&mut self) -> Result<(), DebugProbeError> {
        Ok(())
    }

    fn detach(&mut self) -> Result<(), probe_rs::Error> {
        Ok(())
    }

    fn target_reset(&mut self) -> Result<(), DebugProbeError> {
        self.machine.lock().unwrap().reset();
        Ok(())
    }

    fn target_reset_assert(&mut self) -> Result<(), DebugProbeError> {
        Ok(())
    }

    fn target_reset_deassert(&mut self) -> Result<(), DebugProbeError> {
        self.target_reset()
    }

    fn select_protocol(&mut self, protocol: WireProtocol) -> Result<(), DebugProbeError> {
        match protocol {
            WireProtocol::Swd => Ok(()),
            other => Err(DebugProbeError::UnsupportedProtocol(other)),
        }
    }

    fn active_protocol(&self) -> Option<WireProtocol> {
        Some(WireProtocol::Swd)
    }

    fn has_arm_interface(&self) -> bool {
        true
    }

    fn try_get_arm_debug_interface<'probe>(
        self: Box<Self>,
        sequence: Arc<dyn ArmDebugSequence>,
    ) -> Result<Box<dyn ArmDebugInterface + 'probe>, (Box<dyn DebugProbe>, ArmError)> {
        Ok(ArmCommunicationInterface::create(self, sequence, false))
    }

    fn into_probe(self: Box<Self>) -> Box<dyn DebugProbe> {
        self
    }

    fn try_as_dap_probe(&mut self) -> Option<&mut dyn DapProbe> {
        Some(self)
    }
}
