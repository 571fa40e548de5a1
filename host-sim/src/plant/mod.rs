//! The mechanical side: device and hand between two ticks.
