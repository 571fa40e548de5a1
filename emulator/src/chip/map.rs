//! Address map of the chip's registers.

/// A peripheral of the chip, as a block of registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Block {
    Timer(usize),
    Iwdg,
    Wwdg,
    Spi3,
    Usart2,
    Pwr,
    Lpuart1,
    Syscfg,
    Analog,
    Exti,
    Tim1,
    Dma,
    Rcc,
    Flash,
    Port(usize),
    Adc(usize),
    AdcCommon,
    Dac,
    Other,
}

/// The register of RCC and the bit in it that enable a block's clock (RM0440, 7.4.13 to 7.4.19). `None`: the block always has a
/// clock, or its clock is not modelled.
type Clock = Option<(u32, u32)>;

/// Start address, length in bytes, block and clock of each peripheral that the firmware uses (RM0440, table 3).
pub(super) const MAP: &[(u32, u32, Block, Clock)] = &[
    (0x4000_0000, 0x400, Block::Timer(0), Some((0x58, 0))),
    (0x4000_0400, 0x400, Block::Timer(1), Some((0x58, 1))),
    (0x4000_0800, 0x400, Block::Timer(2), Some((0x58, 2))),
    (0x4000_0c00, 0x400, Block::Timer(3), Some((0x58, 3))),
    (0x4000_2c00, 0x400, Block::Wwdg, Some((0x58, 11))),
    (0x4000_3000, 0x400, Block::Iwdg, None),
    (0x4000_3c00, 0x400, Block::Spi3, Some((0x58, 15))),
    (0x4000_4400, 0x400, Block::Usart2, Some((0x58, 17))),
    (0x4000_7000, 0x400, Block::Pwr, Some((0x58, 28))),
    (0x4000_8000, 0x400, Block::Lpuart1, Some((0x5c, 0))),
    // SYSCFG with VREFBUF and COMP, and OPAMP.
    (0x4001_0000, 0x300, Block::Syscfg, Some((0x60, 0))),
    (0x4001_0300, 0x100, Block::Analog, Some((0x60, 0))),
    (0x4001_0400, 0x400, Block::Exti, None),
    (0x4001_2c00, 0x400, Block::Tim1, Some((0x60, 11))),
    (0x4002_0000, 0xc00, Block::Dma, None),
    (0x4002_1000, 0x400, Block::Rcc, None),
    (0x4002_2000, 0x400, Block::Flash, None),
    (0x4800_0000, 0x400, Block::Port(0), Some((0x4c, 0))),
    (0x4800_0400, 0x400, Block::Port(1), Some((0x4c, 1))),
    (0x4800_0800, 0x400, Block::Port(2), Some((0x4c, 2))),
    (0x4800_0c00, 0x400, Block::Port(3), Some((0x4c, 3))),
    (0x4800_1000, 0x400, Block::Port(4), Some((0x4c, 4))),
    (0x4800_1400, 0x400, Block::Port(5), Some((0x4c, 5))),
    (0x4800_1800, 0x400, Block::Port(6), Some((0x4c, 6))),
    (0x5000_0000, 0x100, Block::Adc(0), Some((0x4c, 13))),
    (0x5000_0100, 0x100, Block::Adc(1), Some((0x4c, 13))),
    (0x5000_0300, 0x100, Block::AdcCommon, Some((0x4c, 13))),
    (0x5000_0800, 0x400, Block::Dac, Some((0x4c, 16))),
    // DAC3.
    (0x5000_1000, 0x400, Block::Other, Some((0x4c, 18))),
];
