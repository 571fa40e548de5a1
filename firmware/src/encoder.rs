//! Counts an incremental encoder's edges with a timer.

/// Makes a timer count the edges of both tracks of an incremental encoder, with a filter of 0.4 us against spikes. It is a macro
/// because 16-bit and 32-bit timers have different Rust types with the same registers.
macro_rules! count_edges {
    ($timer:ident) => {{
        use embassy_stm32::pac::timer::vals::{CcmrInputCcs, FilterValue, Sms};
        embassy_stm32::rcc::enable_and_reset::<embassy_stm32::peripherals::$timer>();
        embassy_stm32::pac::$timer.ccmr_input(0).write(|w| {
            for track in 0..2 {
                w.set_ccs(track, CcmrInputCcs::TI4);
                w.set_icf(track, FilterValue::FDTS_DIV8_N8);
            }
        });
        embassy_stm32::pac::$timer
            .smcr()
            .write(|w| w.set_sms(Sms::ENCODER_MODE_3));
        embassy_stm32::pac::$timer.cr1().write(|w| w.set_cen(true));
    }};
}
pub(crate) use count_edges;
