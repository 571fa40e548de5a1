//! What may go wrong, and what is done about it: limits become faults, the first of them is latched by the fault machine.
