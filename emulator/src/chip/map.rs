//! Which registers are where.

/// A block of registers by its place.
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

/// RM0440, table 3: the part that the firmware uses.
pub(super) const MAP: &[(u32, u32, Block)] = &[
    (0x4000_0000, 0x400, Block::Timer(0)),
    (0x4000_0400, 0x400, Block::Timer(1)),
    (0x4000_0800, 0x400, Block::Timer(2)),
    (0x4000_0c00, 0x400, Block::Timer(3)),
    (0x4000_2c00, 0x400, Block::Wwdg),
    (0x4000_3000, 0x400, Block::Iwdg),
    (0x4000_3c00, 0x400, Block::Spi3),
    (0x4000_4400, 0x400, Block::Usart2),
    (0x4000_7000, 0x400, Block::Pwr),
    (0x4000_8000, 0x400, Block::Lpuart1),
    // SYSCFG with VREFBUF and COMP, and OPAMP.
    (0x4001_0000, 0x300, Block::Syscfg),
    (0x4001_0300, 0x100, Block::Analog),
    (0x4001_0400, 0x400, Block::Exti),
    (0x4001_2c00, 0x400, Block::Tim1),
    (0x4002_0000, 0xc00, Block::Dma),
    (0x4002_1000, 0x400, Block::Rcc),
    (0x4002_2000, 0x400, Block::Flash),
    (0x4800_0000, 0x400, Block::Port(0)),
    (0x4800_0400, 0x400, Block::Port(1)),
    (0x4800_0800, 0x400, Block::Port(2)),
    (0x4800_0c00, 0x400, Block::Port(3)),
    (0x4800_1000, 0x400, Block::Port(4)),
    (0x4800_1400, 0x400, Block::Port(5)),
    (0x4800_1800, 0x400, Block::Port(6)),
    (0x5000_0000, 0x100, Block::Adc(0)),
    (0x5000_0100, 0x100, Block::Adc(1)),
    (0x5000_0300, 0x100, Block::AdcCommon),
    (0x5000_0800, 0x400, Block::Dac),
];
