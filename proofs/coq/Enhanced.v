(** The enhanced law over the integers (thesis Algorithm 3.1, Fig. 3.18; the virtual mass of section 3.5 by backward Euler): what
    control/src/law/enhanced.rs computes and proofs/src/spec/enhanced.rs specifies. Numbers are integers in quanta as in Guard.v:
    signals and ratios have 24 fractional bits, gains 12, energies 48. *)

Require Import ZArith Bool.
From Touchstone Require Import Guard Laws.
Open Scope Z_scope.

(** The coefficients. *)
Record enhanced : Set := {
  desired : Z;          (* k_de, gain *)
  target : Z;           (* the stiffness that the offset regulates to, gain *)
  soft : Z;             (* k_v, gain *)
  compliance : Z;       (* 1/k_v, ratio *)
  of_ideal : Z;         (* fraction of the ideal step (3.7, 3.8), ratio *)
  of_force : Z;         (* b/k_v (3.9), ratio *)
  of_penetration : Z;   (* a (3.11), ratio *)
  at_hip : bool;        (* the stiffness at the HIP is regulated, not that at the mass *)
  every_tick : bool;    (* the offset changes at every tick, not only while the mass moves inward *)
  mass_exact : bool;    (* the energy counts the mass' next displacement, not the last *)
  keep_force : bool;    (* the force of the first contact is kept at its end (2.16, 2.17) *)
  inertia : Z;          (* m/T^2, gain *)
  coupling : Z;         (* k_f, gain *)
  mass_damping : Z;     (* c_f/T, gain *)
  total : Z;            (* m/T^2 + k_f + c_f/T + c_env/T, gain *)
  series : Z;           (* k_f + k_v, gain *)
  credit : Z;           (* lent to each contact, energy *)
  limit : Z             (* largest force *)
}.

Inductive contact_phase : Set := Free | First | Augmenting.

(** The memory. The force that a tick returns is [hip_force] of the memory after that tick. *)
Record state : Set := {
  phase : contact_phase;
  last : Z;             (* penetration of the last tick *)
  hip_force : Z;        (* force on the HIP *)
  left : Z;             (* energy left, the loan included *)
  mass : Z;             (* penetration of the virtual mass *)
  mass_moved : Z;       (* its displacement in the last tick *)
  offset : Z;           (* O *)
  at_mass : Z           (* force of the wall on the mass *)
}.

(** The memory without a contact: only the penetration is stored. *)
Definition free_at (e : Z) : state :=
  {| phase := Free; last := e; hip_force := 0; left := 0; mass := 0; mass_moved := 0; offset := 0; at_mass := 0 |}.

(** A number limited to the range of a signal. *)
Definition signal (x : Z) : Z := Z.max (Z.min x highest_signal) lowest_signal.

(** The outward force of a tension, rounded down and rounded up; zero for a negative tension. *)
Definition outward (tension : Z) : Z := Z.min (Z.max tension 0 / gain_one) highest_signal.
Definition outward_up (tension : Z) : Z := Z.min ((Z.max tension 0 + gain_one - 1) / gain_one) highest_signal.

(** A fraction of a signal, and a spring's stretch under a tension; both rounded towards zero. *)
Definition share (ratio x : Z) : Z := within (Z.quot (ratio * x) signal_one) highest_signal.
Definition per (tension stiffness : Z) : Z := within (Z.quot tension stiffness) highest_signal.

Definition size (x : Z) : Z := Z.min (Z.abs x) highest_signal.

(** * The end of the first contact *)

(** The energy that is taken off for the coupling's stretch: half of force times stretch, with force and result rounded up. *)
Definition stored (L : enhanced) (stretch : Z) : Z := (outward_up (coupling L * stretch) * stretch + 1) / 2.

(** The virtual mass takes over the contact. If the energy left does not cover the coupling's stretch, the mass starts at the
    HIP. *)
Definition hand_over (L : enhanced) (m : state) : state :=
  let e := last m in
  let place := if keep_force L then signal (e - per (hip_force m * gain_one) (coupling L))
               else per (coupling L * e) (series L) in
  let offset' := if keep_force L then Z.max (signal (share (compliance L) (hip_force m) - place)) 0 else 0 in
  let stretch := size (signal (e - place)) in
  let covered := (coupling L * stretch <=? highest_signal * gain_one) && (stored L stretch <=? left m) in
  let place' := if covered then place else e in
  {| phase := Augmenting; last := e; hip_force := hip_force m;
     left := if covered then left m - stored L stretch else Z.max (left m) 0;
     mass := place'; mass_moved := 0; offset := offset';
     at_mass := outward (soft L * signal (place' + offset')) |}.

(** * The offset (Algorithm 3.1, lines 7 to 13) *)

Definition due (L : enhanced) (m : state) : bool := every_tick L || (0 <? mass_moved m).

(** The position at which the stiffness is regulated, the force there, and the wanted force. *)
Definition regulated_at (L : enhanced) (m : state) (e : Z) : Z := if at_hip L then e else mass m.
Definition regulated (L : enhanced) (m : state) : Z := if at_hip L then hip_force m else at_mass m.
Definition regulated_to (L : enhanced) (m : state) (e : Z) : Z := Z.min (spring (target L) (regulated_at L m e)) (limit L).

(** The three bounds of a step: a fraction of the ideal step (3.7, 3.8), a bound by the force (3.9), one by the penetration
    (3.11). *)
Definition ideal (L : enhanced) (m : state) (e : Z) : Z :=
  share (of_ideal L) (size (signal (regulated_to L m e - regulated L m))).
Definition weber (L : enhanced) (m : state) : Z := Z.max (share (of_force L) (Z.max (regulated L m) 1)) 1.
Definition near (L : enhanced) (m : state) (e : Z) : Z := share (of_penetration L) (size (regulated_at L m e)).

Definition offset_step (L : enhanced) (m : state) (e : Z) : Z := Z.min (Z.min (ideal L m e) (weber L m)) (near L m e).

Definition next_offset (L : enhanced) (m : state) (e : Z) : Z :=
  if due L m then
    let changed := if regulated L m <? regulated_to L m e then offset m + offset_step L m e else offset m - offset_step L m e in
    Z.max (signal changed) 0
  else offset m.

(** * The virtual mass *)

(** The mass' displacement [d' = (N0 - f)/D], rounded towards zero and limited to the range of positions. [N0] is [drive], [D] is
    [total]. *)
Definition displacement (L : enhanced) (from drive f : Z) : Z :=
  signal (signal (from + per (drive - f * gain_one) (total L)) - from).

(** The terms that drive the mass, without the wall's force: [m d/T^2 + k_f (e - x) + c_f moved/T]. [x] is the mass' position, [d]
    its last displacement, [moved] the HIP's displacement. *)
Definition drive_of (L : enhanced) (m : state) (e moved : Z) : Z :=
  inertia L * mass_moved m + coupling L * signal (e - mass m) + mass_damping L * moved.

(** The force of the coupling on the HIP, rounded towards zero, for a mass at [place] that moved by [step]. *)
Definition coupled (L : enhanced) (place step e moved : Z) : Z :=
  within (Z.quot (coupling L * signal (e - place) + mass_damping L * signal (moved - step)) gain_one) highest_signal.

(** Energy, force and displacement of the mass such that [E' = E + f d' >= 0]. *)
Definition affordable_move (L : enhanced) (energy place drive wanted : Z) : Z * Z * Z :=
  let step := displacement L place drive wanted in
  let after := energy + wanted * step in
  if 0 <=? after then (Z.min after energy_cap, wanted, step)
  else
    let retreat := energy / wanted in
    let f := Z.min (outward_up (drive + total L * retreat)) wanted in
    if f =? 0 then (energy, 0, displacement L place drive 0)
    else (energy - f * retreat, f, - retreat).

(** The same with the observer of Fig. 3.18, which uses the mass' last displacement instead of the next one. *)
Definition thesis_move (L : enhanced) (m : state) (drive wanted : Z) : Z * Z * Z :=
  let (f, energy) := thesis_step (left m) wanted (mass_moved m) in
  (energy, f, displacement L (mass m) drive f).

Definition move_mass (L : enhanced) (m : state) (drive wanted : Z) : Z * Z * Z :=
  if mass_exact L then affordable_move L (left m) (mass m) drive wanted else thesis_move L m drive wanted.

(** The coupling would pull the HIP, so the mass is left behind: it moves as if it were not coupled. With the exact observer it
    moves only if the energy covers the move, and otherwise stands still. *)
Definition leave_behind (L : enhanced) (m : state) (energy f wanted : Z) : Z * Z * Z :=
  let force := if mass_exact L then wanted else f in
  let step := displacement L (mass m) (inertia L * mass_moved m) force in
  if mass_exact L then
    let after := left m + force * step in
    if 0 <=? after then (Z.min after energy_cap, force, step) else (left m, force, 0)
  else (energy, force, step).

(** * The tick *)

(** The memory after a move of the mass; [it] is the energy, force and displacement. *)
Definition moved_on (m : state) (it : Z * Z * Z) (e offset' shown : Z) : state :=
  let '(energy, f, step) := it in
  {| phase := Augmenting; last := e; hip_force := shown; left := energy;
     mass := signal (mass m + step); mass_moved := step; offset := offset'; at_mass := f |}.

(** The force with which the soft spring pushes the mass out. Its deformation is the mass' penetration plus the offset. *)
Definition wanted_of (L : enhanced) (m : state) (offset' : Z) : Z := outward (soft L * signal (mass m + offset')).

(** A tick after the first contact. *)
Definition augmented (L : enhanced) (m : state) (e moved : Z) : state :=
  let offset' := next_offset L m e in
  let wanted := wanted_of L m offset' in
  if wanted =? 0 then free_at e
  else
    let it := move_mass L m (drive_of L m e moved) wanted in
    let '(energy, f, step) := it in
    let shown := coupled L (signal (mass m + step)) step e moved in
    if (0 <? shown) || ((shown =? 0) && (0 <? e)) then moved_on m it e offset' (Z.min shown (limit L))
    else if e <=? 0 then free_at e
    else moved_on m (leave_behind L m energy f wanted) e offset' (Z.min 0 (limit L)).

(** The energy after a tick of the first contact: the last force times the HIP's displacement is added. *)
Definition booked_first (m : state) (moved : Z) : Z := Z.min (left m + hip_force m * moved) energy_cap.

(** The memory with another energy. *)
Definition with_left (m : state) (energy : Z) : state :=
  {| phase := phase m; last := last m; hip_force := hip_force m; left := energy;
     mass := mass m; mass_moved := mass_moved m; offset := offset m; at_mass := at_mass m |}.

(** A tick of the first contact: the force is that of a spring with the desired stiffness. *)
Definition touched (L : enhanced) (m : state) (e : Z) : state :=
  {| phase := First; last := e; hip_force := Z.min (outward (desired L * e)) (limit L); left := left m;
     mass := mass m; mass_moved := mass_moved m; offset := offset m; at_mass := at_mass m |}.

(** Whether the first contact ends in this tick inside the wall, so that the virtual mass takes over. *)
Definition turns (e moved : Z) : bool := (moved <? 0) && (0 <? e).

(** One tick at the penetration [e] after a displacement [moved]. *)
Definition enhanced_tick (L : enhanced) (m : state) (e moved : Z) : state :=
  match phase m with
  | Free => if 0 <? e then touched L (with_left (free_at e) (credit L)) e else free_at e
  | First =>
      let m := with_left m (booked_first m moved) in
      if turns e moved then augmented L (hand_over L m) e moved
      else if 0 <? e then touched L m e else free_at e
  | Augmenting => augmented L m e moved
  end.
