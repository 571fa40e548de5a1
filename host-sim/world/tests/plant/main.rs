//! The plant against independent oracles: fine Runge–Kutta steps with located events, set-valued implicit Euler steps, the
//! matrix exponential of another library, the balance of energy, and the analytic limit of the sampled loop.

mod energy;
mod exact;
mod friction;
mod oracle;
mod sampled_loop;
mod train;
mod train_friction;
