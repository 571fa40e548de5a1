//! Tests of the plants against independent references: fine Runge–Kutta steps with located events, set-valued implicit Euler steps,
//! and the matrix exponential of another library. Further references are the energy balance and the analytic stability limit of the
//! sampled loop.

mod energy;
mod exact;
mod friction;
mod oracle;
mod sampled_loop;
mod train;
mod train_friction;
