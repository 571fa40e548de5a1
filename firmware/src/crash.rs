//! What happens when the program cannot go on: outputs off, then a reset.

use core::panic::PanicInfo;

use crate::pwm;

#[panic_handler]
fn panic(_info: &PanicInfo) -> ! {
    pwm::outputs_off();
    cortex_m::peripheral::SCB::sys_reset()
}
