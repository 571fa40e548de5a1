// The story in seven steps. `sets` are changes of the shipped scene thesis-knob, `b` are those of the run beside it on top of them.
const PRESETS = [
  { name: "A spring that rings", sets: ["law.kind=spring"], strength: 0.3,
    text: "A plain spring of 5 N·m/rad, sampled a thousand times a second: five times what the device's damping makes up for. Touch it and it rings: each sample comes too late, and gives back more than it took." },
  { name: "Count the energy: TDPA", sets: ["law.kind=tdpa"],
    text: "The time-domain passivity approach counts the energy and shrinks the force when the wall would give more than it got. The count is right; the force jumps, and the wall chatters." },
  { name: "Stay soft: FBA", sets: ["law.kind=fba"],
    text: "The force bounding approach never lets the force grow beyond what the damping can absorb. Quiet, but whatever you ask for, you get about 1 N·m/rad: watch the displayed stiffness stay below the dashed line." },
  { name: "Move the wall: SFA", sets: ["law.kind=sfa"],
    text: "Successive force augmentation starts as a soft spring and moves its surface outwards, step by step, until the force is that of a stiff one. The original takes its steps at once, and throws the hand out." },
  { name: "The law as published",
    sets: ["law.kind=enhanced-sfa", "law.observer=thesis", "law.offset_update=inward", "law.ideal_step=position", "law.filter.ground_damping_n_m_s_per_rad=8e-4"],
    text: "Enhanced SFA puts a small virtual mass between hand and wall and moves the surface behind it. As it was published it moves inwards only, on the wrong sign of the sampling leak: a ratchet that jitters." },
  { name: "Ours, at 20 N·m/rad", sets: ["law.kind=enhanced-sfa", "wall.k_desired_n_m_per_rad=20"], b: ["law.kind=spring"],
    text: "The same idea with the books kept right and an offset that follows the hand both ways: twenty times the critical stiffness, at rest under your finger. Beside it, under the same hand, a spring of the same stiffness." },
  { name: "The adversary", sets: ["law.kind=enhanced-sfa", "wall.k_desired_n_m_per_rad=20", "timing.computational_delay_s=0.002", "operator.grip=light"], b: ["law.kind=spring"],
    text: "The worst of everything: a light grip, two milliseconds of delay, twenty times the critical stiffness." },
];
