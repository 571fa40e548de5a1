(** The energy that the enhanced law's virtual mass and its coupling store over any number of ticks, with rounding. The energy
    that enters by two ports is stored or dissipated. What is dissipated is a sum of squares and of remainders that are not
    negative.

    One port is that of the coupling at the HIP, the other that of the wall at the mass. Both are discrete: each force is
    multiplied by the displacement before it (backward Euler). All values are integers, in quanta of a gain times the square of a
    quantum of position. Energies are doubled. *)

Require Import ZArith Zquot Lia List Bool Psatz.
From Touchstone Require Import Guard Laws LawsArePassive Enhanced EnhancedIsPassive EnhancedOffset.
Import ListNotations.
Open Scope Z_scope.

(** * Energy that is stored and exchanged *)

Definition stretch (m : state) : Z := last m - mass m.

(** [m d^2/T^2 + k_f s^2]: twice the kinetic energy of the mass and the energy of the coupling's spring. [d] is the mass' last
    displacement, [s] the spring's stretch. *)
Definition storage (L : enhanced) (m : state) : Z :=
  inertia L * (mass_moved m * mass_moved m) + coupling L * (stretch m * stretch m).

(** What [total] contains beyond mass, coupling and the coupling's damper: the damper to ground, or more. *)
Definition ground (L : enhanced) : Z := total L - inertia L - coupling L - mass_damping L.

(** Whether the mass is left behind in a tick, because the coupling would pull the HIP. *)
Definition leaves_behind (L : enhanced) (m : state) (e moved : Z) : bool :=
  let '(_, _, step) := move_mass L m (drive_of L m e moved) (wanted_of L m (next_offset L m e)) in
  coupled L (signal (mass m + step)) step e moved <? 0.

(** The coupling's tension after a tick, from its spring and its damper; zero if the mass is left behind. *)
Definition tension (L : enhanced) (m : state) (e moved : Z) : Z :=
  let m' := enhanced_tick L m e moved in
  if leaves_behind L m e moved then 0 else coupling L * stretch m' + mass_damping L * (moved - mass_moved m').

(** The tension less the force on the HIP: what is rounded off, and what the force limit takes off. *)
Definition kept_back (L : enhanced) (m : state) (e moved : Z) : Z :=
  tension L m e moved - gain_one * hip_force (enhanced_tick L m e moved).

(** The remainder [N0 - f - D d'] of the forces on the mass, from rounding or from the limit of positions. [N0] drives the mass,
    [f] is the wall's force, [D] is [total] and [d'] the displacement. *)
Definition residue (L : enhanced) (m : state) (e moved : Z) : Z :=
  let m' := enhanced_tick L m e moved in
  (if leaves_behind L m e moved then inertia L * mass_moved m else drive_of L m e moved)
  - at_mass m' * gain_one - total L * mass_moved m'.

(** Twice the energy dissipated in a tick: by backward Euler itself, by the dampers, and by rounding. *)
Definition dissipated (L : enhanced) (m : state) (e moved : Z) : Z :=
  let d := mass_moved (enhanced_tick L m e moved) in
  let turned := d - mass_moved m in
  let apart := moved - d in
  inertia L * (turned * turned)
  + (if leaves_behind L m e moved then 2 * (total L - inertia L) * (d * d)
     else (coupling L + 2 * mass_damping L) * (apart * apart) + 2 * ground L * (d * d))
  + 2 * (residue L m e moved * d).

(** Twice the energy that the coupling's spring gains if the mass is left behind: the stretch then changes without a force. *)
Definition let_go (L : enhanced) (m : state) (e moved : Z) : Z :=
  let m' := enhanced_tick L m e moved in
  if leaves_behind L m e moved then coupling L * (stretch m' * stretch m' - stretch m * stretch m) else 0.

(** No difference of positions is limited by the format. The displacement is the difference of penetrations. The stretch at the
    new penetration, with the mass at its old and at its new place, and the displacement relative to the mass are in the range of
    a signal. *)
Definition fits (L : enhanced) (m : state) (e moved : Z) : Prop :=
  let m' := enhanced_tick L m e moved in
  moved = e - last m /\ a_signal (e - mass m) /\ a_signal (e - mass m') /\ a_signal (moved - mass_moved m').

(** Position and displacement of the mass have not reached the format's limit. *)
Definition has_room (m : state) : Prop := lowest_signal < mass m < highest_signal /\ Z.abs (mass_moved m) < highest_signal.

(** * Remainders *)

Lemma displacement_towards_zero (L : enhanced) (from drive f : Z) :
  0 < total L -> a_signal from ->
  let d := displacement L from drive f in
  let net := drive - f * gain_one in
  let r := net - total L * d in
  (0 <= net -> 0 <= d /\ 0 <= r) /\ (net <= 0 -> d <= 0 /\ r <= 0)
  /\ (lowest_signal < from + d < highest_signal -> Z.abs d < highest_signal -> Z.abs r < total L).
Proof.
  intros D F d net r.
  assert (Q : Z.abs (Z.quot net (total L)) * total L <= Z.abs net) by (apply towards_zero_is_smaller; exact D).
  assert (Q2 : Z.abs (net - total L * Z.quot net (total L)) < total L).
  { pose proof (Z.quot_rem net (total L) ltac:(lia)) as E. pose proof (Z.rem_bound_abs net (total L) ltac:(lia)).
    replace (net - total L * Z.quot net (total L)) with (Z.rem net (total L)) by lia. lia. }
  assert (Sp : 0 <= net -> 0 <= Z.quot net (total L)) by (intros; apply Z.quot_pos; lia).
  assert (Sn : net <= 0 -> Z.quot net (total L) <= 0).
  { intros N. replace net with (- - net) by lia. rewrite Z.quot_opp_l by lia.
    pose proof (Z.quot_pos (- net) (total L) ltac:(lia) D). lia. }
  unfold r, d, displacement, per. fold net. set (q := Z.quot net (total L)) in *. clearbody q.
  assert (Between : let d := signal (signal (from + within q highest_signal) - from) in
            (0 <= q -> 0 <= d <= q) /\ (q <= 0 -> q <= d <= 0)
            /\ (lowest_signal < from + d < highest_signal -> Z.abs d < highest_signal -> d = q)) by (cbn zeta; numbers).
  cbn zeta in Between. set (x := signal _) in *. clearbody x. destruct Between as (B1 & B2 & B3).
  split; [|split].
  - intros N. specialize (Sp N). specialize (B1 Sp). split; [lia | nia].
  - intros N. specialize (Sn N). specialize (B2 Sn). split; [lia | nia].
  - intros E1 E2. rewrite (B3 E1 E2). exact Q2.
Qed.

(** The remainder [r] of rounding only dissipates: its work is not negative. For each quantum of displacement it is at most the
    larger of [total] and [gain_one], if position and displacement have not reached the format's limit. *)
Definition only_dissipates (L : enhanced) (m : state) (pull f step : Z) : Prop :=
  let r := pull - f * gain_one - total L * step in
  0 <= r * step
  /\ (lowest_signal < mass m + step < highest_signal -> Z.abs step < highest_signal ->
      r * step <= Z.max (total L) gain_one * Z.abs step).

Lemma free_only_dissipates (L : enhanced) (m : state) (pull f : Z) :
  0 < total L -> a_signal (mass m) -> only_dissipates L m pull f (displacement L (mass m) pull f).
Proof.
  intros D P. pose proof (displacement_towards_zero L (mass m) pull f D P) as (A & B & C). cbn zeta in *.
  unfold only_dissipates. set (d := displacement L (mass m) pull f) in *.
  set (net := pull - f * gain_one) in *. set (r := net - total L * d) in *. clearbody d net r.
  assert (0 <= r * d) by (destruct (Z_le_gt_dec 0 net); [specialize (A ltac:(lia)) | specialize (B ltac:(lia))]; nia).
  split; [assumption|]. intros E1 E2. specialize (C E1 E2).
  rewrite <- (Z.abs_eq (r * d)) by assumption. rewrite Z.abs_mul. apply Z.mul_le_mono_nonneg_r; lia.
Qed.

Lemma affordable_only_dissipates (L : enhanced) (m : state) (drive wanted : Z) :
  0 < total L -> a_signal (mass m) -> 0 <= left m -> 0 < wanted <= highest_signal ->
  let '(_, f, step) := affordable_move L (left m) (mass m) drive wanted in only_dissipates L m drive f step.
Proof.
  intros D P E W. unfold affordable_move.
  destruct (0 <=? left m + wanted * displacement L (mass m) drive wanted) eqn:A; [apply free_only_dissipates; assumption|].
  apply Z.leb_gt in A.
  pose proof (displacement_towards_zero L (mass m) drive wanted D P) as (_ & T & _). cbn zeta in T.
  assert (Out : displacement L (mass m) drive wanted < 0) by nia.
  assert (N : drive - wanted * gain_one <= 0).
  { destruct (Z_le_gt_dec (drive - wanted * gain_one) 0); [assumption|].
    pose proof (displacement_towards_zero L (mass m) drive wanted D P) as (T' & _). cbn zeta in T'. lia. }
  destruct (T N) as [_ R]. clear T.
  assert (R0 : 0 <= left m / wanted) by (apply Z.div_pos; lia).
  assert (R1 : wanted * (left m / wanted) <= left m) by (apply Z.mul_div_le; lia).
  set (retreat := left m / wanted) in *. set (x := displacement L (mass m) drive wanted) in *. clearbody retreat x.
  assert (Less : x + retreat < 0) by nia.
  assert (Room : drive + total L * retreat < wanted * gain_one) by nia.
  destruct (Z.min (outward_up (drive + total L * retreat)) wanted =? 0) eqn:F0; [apply free_only_dissipates; assumption|].
  apply Z.eqb_neq in F0.
  set (t := drive + total L * retreat) in *.
  assert (Up : Z.min (outward_up t) wanted = (Z.max t 0 + gain_one - 1) / gain_one).
  { unfold outward_up. assert ((Z.max t 0 + gain_one - 1) / gain_one < wanted + 1); [|lia].
    apply Z.div_lt_upper_bound; [reflexivity|]. numbers. }
  rewrite Up in *.
  assert (G : 0 < gain_one) by reflexivity.
  pose proof (Z.mul_div_le (Z.max t 0 + gain_one - 1) gain_one G) as U1.
  pose proof (Z.mul_succ_div_gt (Z.max t 0 + gain_one - 1) gain_one G) as U2.
  set (f := (Z.max t 0 + gain_one - 1) / gain_one) in *. clearbody f.
  assert (T0 : 0 < t) by nia.
  assert (Rs : drive - f * gain_one - total L * - retreat = t - f * gain_one) by (unfold t; ring).
  unfold only_dissipates. rewrite Rs. clearbody t. set (g := gain_one) in *. clearbody g.
  assert (B : - g < t - f * g <= 0) by nia.
  set (r := t - f * g) in *. clearbody r. rewrite Z.abs_opp, (Z.abs_eq retreat) by lia.
  split; [nia|]. intros _ _.
  assert (- r * retreat <= Z.max (total L) g * retreat) by (apply Z.mul_le_mono_nonneg_r; lia). lia.
Qed.

Lemma move_only_dissipates (L : enhanced) (m : state) (drive wanted energy f step : Z) :
  0 < total L -> carried L m -> 0 < wanted <= highest_signal ->
  move_mass L m drive wanted = (energy, f, step) -> only_dissipates L m drive f step.
Proof.
  intros D [] W M. unfold move_mass in M. destruct (mass_exact L).
  - pose proof (affordable_only_dissipates L m drive wanted D mass_in (proj1 left_is_stored) W) as A. rewrite M in A. exact A.
  - unfold thesis_move in M. destruct (thesis_step _ _ _). injection M as <- <- <-. apply free_only_dissipates; assumption.
Qed.

Lemma coast_only_dissipates (L : enhanced) (m : state) (energy f wanted energy' f' step : Z) :
  0 < total L -> carried L m ->
  leave_behind L m energy f wanted = (energy', f', step) -> only_dissipates L m (inertia L * mass_moved m) f' step.
Proof.
  intros D [] B. unfold leave_behind in B. destruct (mass_exact L); [destruct (0 <=? _)|];
    injection B as <- <- <-; try (apply free_only_dissipates; assumption).
  unfold only_dissipates. rewrite Z.mul_0_r. cbn [Z.abs]. rewrite Z.mul_0_r. lia.
Qed.

(** * One tick *)

(** The energy that the wall takes from the mass in a tick: force times displacement, as in [taken_from_mass]. *)
Definition from_mass (L : enhanced) (m : state) (e moved : Z) : Z :=
  let m' := enhanced_tick L m e moved in at_mass m' * mass_moved m'.

Section Ticks.

Variable L : enhanced.
Hypothesis Valid : valid L.

Lemma ground_nonneg : 0 <= ground L.
Proof. destruct Valid. unfold ground. lia. Qed.

(** A tick that stays in contact has one of the forms of [goes_on] and keeps the invariant. *)
Lemma tick_goes_on (m : state) (e moved : Z) :
  carried L m -> phase (enhanced_tick L m e moved) = Augmenting ->
  0 < wanted_of L m (next_offset L m e) <= highest_signal /\ goes_on L m e moved (enhanced_tick L m e moved)
  /\ carried L (enhanced_tick L m e moved).
Proof.
  intros C Ph. assert (T : enhanced_tick L m e moved = augmented L m e moved)
    by (unfold enhanced_tick; rewrite (is_augmenting L m C); reflexivity).
  rewrite T in *. destruct (augmented_goes_on L Valid m e moved C) as [E|(W & G & K)]; [rewrite E in Ph; discriminate|].
  pose proof (outward_in (soft L * signal (mass m + next_offset L m e))) as O. fold (wanted_of L m (next_offset L m e)) in O.
  split; [lia | split; assumption].
Qed.

(** The identity of a tick. Energy stored after the tick + dissipated energy + energy that the wall took from the mass = energy
    stored before the tick + energy that the coupling took from the hand + energy that its spring gained while the mass was left
    behind. *)
Lemma storage_of_a_tick (m : state) (e moved : Z) :
  carried L m -> fits L m e moved -> phase (enhanced_tick L m e moved) = Augmenting ->
  storage L (enhanced_tick L m e moved) + dissipated L m e moved + 2 * gain_one * from_mass L m e moved
  = storage L m + 2 * (tension L m e moved * moved) + let_go L m e moved.
Proof.
  intros C (Ex & F0 & F1 & F2) Ph.
  destruct (tick_goes_on m e moved C Ph) as (W & G & _).
  assert (Place : mass (enhanced_tick L m e moved) = mass m + mass_moved (enhanced_tick L m e moved)
                  /\ last (enhanced_tick L m e moved) = e).
  { destruct G; cbn [moved_on mass mass_moved last]; rewrite signal_same by assumption; split; reflexivity. }
  destruct Place as [Pl La].
  assert (Same : signal (e - mass m) = e - mass m) by (apply signal_same; exact F0).
  unfold storage, dissipated, tension, let_go, residue, from_mass, drive_of, stretch, ground in *.
  rewrite La, Pl, Same in *. set (m' := enhanced_tick L m e moved) in *. clearbody m'.
  replace (last m) with (e - moved) by lia.
  destruct (leaves_behind L m e moved); ring.
Qed.

(** The dissipated energy is a sum of squares and of a remainder. The remainder is not negative, and at most the larger of [total]
    and one quantum of force, times the mass' displacement. *)
Lemma rounding_dissipates (m : state) (e moved : Z) :
  carried L m -> phase (enhanced_tick L m e moved) = Augmenting ->
  let r := residue L m e moved * mass_moved (enhanced_tick L m e moved) in
  0 <= r /\ 2 * r <= dissipated L m e moved
  /\ (has_room (enhanced_tick L m e moved) ->
      r <= Z.max (total L) gain_one * Z.abs (mass_moved (enhanced_tick L m e moved))).
Proof.
  intros C Ph r. destruct (tick_goes_on m e moved C Ph) as (W & G & _).
  pose proof ground_nonneg as Gr. destruct Valid.
  assert (D : 0 < total L) by assumption.
  assert (R : 0 <= r /\ (has_room (enhanced_tick L m e moved) ->
      r <= Z.max (total L) gain_one * Z.abs (mass_moved (enhanced_tick L m e moved)))).
  { unfold r, residue, leaves_behind. set (m' := enhanced_tick L m e moved) in *. clearbody m'.
    destruct G as [energy f step shown Mv Sh S0 P | energy f step energy' f' Mv P1 S0 step' Lb P];
      rewrite Mv; unfold has_room; cbn [moved_on mass mass_moved at_mass].
    - rewrite (signal_same _ P). rewrite <- Sh, (proj2 (Z.ltb_ge shown 0) S0).
      destruct (move_only_dissipates L m _ _ _ _ _ D C W Mv) as [A B]. split; [exact A|]. intros [H1 H2]. exact (B H1 H2).
    - rewrite (signal_same _ P1), (signal_same _ P), (proj2 (Z.ltb_lt _ 0) S0).
      destruct (coast_only_dissipates L m _ _ _ _ _ _ D C Lb) as [A B]. split; [exact A|]. intros [H1 H2]. exact (B H1 H2). }
  destruct R as [R0 R1]. split; [exact R0|split; [|exact R1]].
  unfold dissipated. fold r. set (d := mass_moved _) in *.
  assert (0 <= inertia L * ((d - mass_moved m) * (d - mass_moved m))) by (apply Z.mul_nonneg_nonneg; [lia | apply Z.square_nonneg]).
  assert (0 <= 2 * (total L - inertia L) * (d * d)) by (apply Z.mul_nonneg_nonneg; [lia | apply Z.square_nonneg]).
  assert (0 <= (coupling L + 2 * mass_damping L) * ((moved - d) * (moved - d))) by (apply Z.mul_nonneg_nonneg; [lia | apply Z.square_nonneg]).
  assert (0 <= 2 * ground L * (d * d)) by (apply Z.mul_nonneg_nonneg; [lia | apply Z.square_nonneg]).
  unfold r. destruct (leaves_behind L m e moved); lia.
Qed.

(** Bounds of the difference [r] of a tension [t] and its force, which is rounded towards zero and limited to the format and to
    [l]. *)
Lemma rounded_off (t l shown : Z) :
  0 <= l <= highest_signal -> shown = within (Z.quot t gain_one) highest_signal -> 0 <= shown ->
  let r := t - gain_one * Z.min shown l in
  - gain_one < r /\ (0 < Z.min shown l -> 0 <= r) /\ (Z.min shown l < l -> r < gain_one).
Proof.
  unfold within. intros Hl Sh S0.
  assert (G : 0 < gain_one) by reflexivity. generalize dependent gain_one. intros g Sh G.
  assert (H : 0 < highest_signal) by reflexivity. generalize dependent highest_signal. intros h Hl Sh H.
  pose proof (Z.quot_rem t g ltac:(lia)) as Q.
  destruct (Z_le_gt_dec 0 t) as [N|N].
  - pose proof (Z.rem_bound_pos t g N G) as B. pose proof (Z.quot_pos t g N G) as P.
    set (q := Z.quot t g) in *. set (u := Z.rem t g) in *. clearbody q u.
    assert (Le : Z.min shown l <= q) by lia. assert (g * Z.min shown l <= g * q) by (apply Z.mul_le_mono_nonneg_l; lia).
    split; [lia|split; [lia|]]. intros Lt. assert (E : Z.min shown l = q) by lia. rewrite E. lia.
  - assert (P : Z.quot t g <= 0).
    { replace t with (- - t) by lia. rewrite Z.quot_opp_l by lia. pose proof (Z.quot_pos (- t) g ltac:(lia) G). lia. }
    assert (B : - g < Z.rem t g <= 0).
    { replace t with (- - t) by lia. rewrite Z.rem_opp_l by lia. pose proof (Z.rem_bound_pos (- t) g ltac:(lia) G). lia. }
    set (q := Z.quot t g) in *. set (u := Z.rem t g) in *. clearbody q u.
    assert (E : shown = 0 /\ q = 0) by lia. destruct E as [-> ->].
    rewrite Z.min_l by lia. rewrite Z.mul_0_r in *. lia.
Qed.

(** The force on the HIP is the coupling's tension, rounded towards zero. Below the force limit the two differ by less than a
    quantum of force, and a positive force is never larger than the tension. At the force limit the force can be smaller by
    more. *)
Lemma kept_back_of_a_tick (m : state) (e moved : Z) :
  carried L m -> fits L m e moved -> phase (enhanced_tick L m e moved) = Augmenting ->
  let m' := enhanced_tick L m e moved in
  - gain_one < kept_back L m e moved
  /\ (0 < hip_force m' -> 0 <= kept_back L m e moved)
  /\ (hip_force m' < limit L \/ leaves_behind L m e moved = true -> kept_back L m e moved < gain_one).
Proof.
  intros C (Ex & F0 & F1 & F2) Ph m'. destruct (tick_goes_on m e moved C Ph) as (W & G & _).
  unfold kept_back, tension, leaves_behind. fold m' in F1, F2, G |- *. clearbody m'. destruct Valid as [[Li0 Li] _ _ _ _ _ _ _ _ _ _].
  destruct G as [energy f step shown Mv Sh S0 P | energy f step energy' f' Mv P1 S0 step' Lb P];
    rewrite Mv; cbn [moved_on mass mass_moved last hip_force] in *; unfold stretch; cbn [moved_on mass mass_moved last hip_force].
  - rewrite (signal_same _ P) in *. rewrite <- Sh, (proj2 (Z.ltb_ge shown 0) S0).
    unfold coupled in Sh. rewrite (signal_same _ F1), (signal_same _ F2) in Sh.
    destruct (rounded_off _ (limit L) shown (conj Li0 Li) Sh S0) as (R1 & R2 & R3).
    split; [exact R1|split; [exact R2|]]. intros [H|H]; [exact (R3 H) | discriminate].
  - rewrite (signal_same _ P1), (proj2 (Z.ltb_lt _ 0) S0).
    rewrite Z.mul_0_r. assert (0 < gain_one) by reflexivity. split; [lia|split; lia].
Qed.

End Ticks.

(** * Any number of ticks *)

(** A sum over the ticks of a window. *)
Fixpoint over (L : enhanced) (it : state -> Z -> Z -> Z) (m : state) (h : hand) : Z :=
  match h with [] => 0 | (e, moved) :: h => it m e moved + over L it (enhanced_tick L m e moved) h end.

Fixpoint every (L : enhanced) (it : state -> Z -> Z -> Prop) (m : state) (h : hand) : Prop :=
  match h with [] => True | (e, moved) :: h => it m e moved /\ every L it (enhanced_tick L m e moved) h end.

(** The work of the coupling's tension, of the force on the HIP, and of their difference: each times the displacement before it.
    [way] is the size of this displacement. *)
Definition by_tension (L : enhanced) (m : state) (e moved : Z) : Z := tension L m e moved * moved.
Definition by_force (L : enhanced) (m : state) (e moved : Z) : Z := hip_force (enhanced_tick L m e moved) * moved.
Definition by_kept_back (L : enhanced) (m : state) (e moved : Z) : Z := kept_back L m e moved * moved.
Definition way (m : state) (e moved : Z) : Z := Z.abs moved.

(** The force on the HIP stays below the limit, or the mass is left behind. *)
Definition below_limit (L : enhanced) (m : state) (e moved : Z) : Prop :=
  hip_force (enhanced_tick L m e moved) < limit L \/ leaves_behind L m e moved = true.

(** The storage identity over any number of ticks, for both observers. The dissipated energy is not negative. *)
Theorem storage_is_kept (L : enhanced) (m : state) (h : hand) :
  valid L -> carried L m -> in_format h -> stays L m h -> every L (fits L) m h ->
  storage L (enhanced_run L m h) + over L (dissipated L) m h + 2 * gain_one * over L (from_mass L) m h
  = storage L m + 2 * over L (by_tension L) m h + over L (let_go L) m h
  /\ 0 <= over L (dissipated L) m h.
Proof.
  intros V. revert m. induction h as [|[e moved] h IH]; intros m C F St Fi; cbn [enhanced_run over]; [lia|].
  inversion F; subst. destruct St as [_ St]. destruct Fi as [Fi1 Fi]. pose proof (stays_now _ _ _ St) as Ph.
  destruct (tick_goes_on L V m e moved C Ph) as (_ & _ & C').
  destruct (IH _ C' H2 St Fi) as [I1 I2].
  pose proof (storage_of_a_tick L V m e moved C Fi1 Ph) as T. pose proof (rounding_dissipates L V m e moved C Ph) as R.
  cbn zeta in R. unfold by_tension at 1. lia.
Qed.

(** The work of the force on the HIP differs from that of the tension by [by_kept_back]. Below the force limit this difference is
    at most a quantum of force times the size of each displacement. *)
Theorem force_is_the_tension_rounded (L : enhanced) (m : state) (h : hand) :
  valid L -> carried L m -> in_format h -> stays L m h -> every L (fits L) m h ->
  over L (by_tension L) m h = gain_one * over L (by_force L) m h + over L (by_kept_back L) m h
  /\ (every L (below_limit L) m h -> Z.abs (over L (by_kept_back L) m h) <= gain_one * over L way m h).
Proof.
  intros V. revert m. induction h as [|[e moved] h IH]; intros m C F St Fi; cbn [over every]; [lia|].
  inversion F; subst. destruct St as [_ St]. destruct Fi as [Fi1 Fi]. pose proof (stays_now _ _ _ St) as Ph.
  destruct (tick_goes_on L V m e moved C Ph) as (_ & _ & C').
  destruct (IH _ C' H2 St Fi) as [I1 I2].
  pose proof (kept_back_of_a_tick L V m e moved C Fi1 Ph) as (K1 & _ & K2).
  split.
  - rewrite I1. unfold by_tension, by_force, by_kept_back, kept_back. ring.
  - intros [B1 B]. specialize (I2 B). specialize (K2 B1). unfold by_kept_back at 1, way at 1.
    assert (Z.abs (kept_back L m e moved * moved) <= gain_one * Z.abs moved).
    { rewrite Z.abs_mul. apply Z.mul_le_mono_nonneg_r; lia. }
    lia.
Qed.
