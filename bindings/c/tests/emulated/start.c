/* Start-up code for a C program on QEMU's board mps2-an386. The program's output goes to the host by semihosting. */
#include <stdint.h>
#include <stdlib.h>

extern uint32_t stack_end;
extern void initialise_monitor_handles(void);
extern int main(void);

static void start(void) {
#ifdef __ARM_FP
  *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* CPACR: switches the floating-point unit on */
#endif
  initialise_monitor_handles();
  exit(main());
}

static void fault(void) { _Exit(99); }

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    &stack_end, (void *)start, (void *)fault, (void *)fault, (void *)fault, (void *)fault, (void *)fault};
