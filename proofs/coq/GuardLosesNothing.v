(** The energy guard's theorem, for every hand, every law and any number of ticks. What a hand gets out of the device's port in a
    window of time is at most the account's capacity, the refill meanwhile, and half an encoder count times the force that acted
    when the window began.

    The specification is Guard.v; the port and its damping are Port.v. This file defines the devices that a guard covers
    ([covers]) and the events of a device with a hand ([event], [possible], [after]). It proves the invariant ([sound]) and the
    theorem [any_window]. *)

Require Import ZArith QArith Qabs Qminmax Lqa Lia List Bool.
From Touchstone Require Import Guard Port.
Import ListNotations.
Open Scope Q_scope.

Coercion inject_Z : Z >-> Q.

(** * A device that the guard's coefficients cover *)

Record device : Set := {
  c : Q;      (* its damping over a tick, without the hand: energy = c moved^2 *)
  s : Q;      (* mean delay in ticks after which a new force begins to act *)
  r : Q;      (* fraction of the displacement after the reported change with the old force; s if no position is read there *)
  d : Q;      (* largest displacement in a tick: at most s d before the change of force and (1-s) d after it *)
  delta : Q;  (* twice the largest error of a measured position *)
  kappa : Q;  (* what an uneven motion can gain, divided by the change of force squared: s (1-s)/4c, or more *)
  way_after : Q;  (* largest measured displacement after the change of force *)
  rough : Q   (* rounding of the position at the change of force, in addition to its error *)
}.

(** The largest force that a guard ever allows: that of a full account. *)
Definition largest (G : guard) : Z := largest_force G (capacity G).

Record covers (G : guard) (D : device) : Prop := {
  share : 0 <= s D <= 1;
  way_after_nonneg : 0 <= way_after D;
  c_nonneg : 0 <= c D;
  d_nonneg : 0 <= d D;
  delta_nonneg : 0 <= delta D;
  kappa_nonneg : 0 <= kappa D;
  capacity_nonneg : (0 <= capacity G)%Z;
  refill_nonneg : (0 <= refill G)%Z;
  damping_nonneg : (0 <= damping G)%Z;
  per_reach_nonneg : (0 <= per_reach G)%Z;
  overrun_nonneg : (0 <= overrun G)%Z;
  (* the trusted damping is at most the device's *)
  damping_is_there : damping G <= c D * gain_one;
  (* the largest error of a displacement *)
  count_covers : delta D <= count G;
  (* the reserve: the largest displacement under the old force after the next sample *)
  flight_covers : s D * d D + delta D * (1 # 2) <= in_flight G;
  (* the largest displacement for which the new force must be covered, with its own reserve *)
  reach_covers : per_reach G * ((1 - s D) * d D + in_flight G + delta D * (1 # 2)) <= gain_one * signal_one;
  (* the charge for a change of force: half a count, roundings, and what [late] and [stray] leave out *)
  slack_covers :
    delta D * (1 # 2) + rough D + 1
    + Qabs (r D - late G / signal_one) * way_after D
    + Qmax 0 (kappa D - stray G / signal_one) * (2 * largest G) <= slack G
}.

(** * A guard with device and hand, one event at a time *)

(** The guard's memory just after a tick; the true position less the measured one; the energy that the port took from the hand so
    far, with the trusted damping's; the number of events. *)
Record world : Set := { memory_of : memory; error : Q; taken : Q; ticks : nat }.

Inductive event : Set :=
| Tick (under early rest damped : Q)              (* moved before the change (estimated, true) and after it; energy dissipated *)
       (error' : Q) (moved : Z)                   (* the next sample: its error, and the measured displacement *)
       (before : Z)                               (* its part before the change of force; 0 if no position is read there *)
       (wanted : Z)                               (* the force that the law wants: any *)
       (told : Z)                                 (* the force that is finally commanded, as reported: any *)
| Off (early rest damped : Q) (error' : Q)         (* the force is switched off within a tick, and no position is read *)
| Away (damped : Q) (error' : Q).                 (* no force acts and no position is read, until arming *)

(** The events that are possible for a covered device with a hand. All other values are arbitrary. *)
Definition possible (G : guard) (D : device) (w : world) (e : event) : Prop :=
  match e with
  | Tick under early rest damped error' moved before _ _ =>
      acts_late (c D) (s D) (d D) (kappa D) under early rest damped
      /\ Qabs error' <= delta D * (1 # 2)
      /\ moved == early + rest + error w - error'
      /\ (Z.abs moved <= furthest G)%Z /\ (Z.abs before <= furthest G)%Z
      (* the displacement that the guard counts under the old force is wrong by at most a position's error and rounding *)
      /\ Qabs (moved - before) <= way_after D
      /\ Qabs (error w + under - (before + r D * (moved - before))) <= delta D * (1 # 2) + rough D
  | Off early rest damped error' =>
      (* for any duration of each force *)
      Qabs early <= s D * d D /\ Qabs rest <= (1 - s D) * d D /\ 0 <= damped /\ Qabs error' <= delta D * (1 # 2)
  | Away damped error' =>
      force (memory_of w) = 0%Z /\ older (memory_of w) = 0%Z /\ 0 <= damped /\ Qabs error' <= delta D * (1 # 2)
  end.

(** The energy that the port takes from the hand. Until the change within the tick the older force acts, then the last one. *)
Definition port (m : memory) (e : event) : Q :=
  match e with
  | Tick _ early rest damped _ _ _ _ _ | Off early rest damped _ => older m * early + force m * rest + damped
  | Away damped _ => damped
  end.

Definition after (G : guard) (w : world) (e : event) : world :=
  {| memory_of :=
       match e with
       | Tick _ _ _ _ _ moved before wanted told => commanded (fst (tick G (memory_of w) moved before wanted)) told
       | Off _ _ _ _ => switched_off G (memory_of w)
       | Away _ _ => memory_of w
       end;
     error := match e with Tick _ _ _ _ error' _ _ _ _ | Off _ _ _ error' | Away _ error' => error' end;
     taken := taken w + port (memory_of w) e;
     ticks := S (ticks w) |}.

Fixpoint run (G : guard) (w : world) (es : list event) : world :=
  match es with [] => w | e :: es => run G (after G w e) es end.

Fixpoint all_possible (G : guard) (D : device) (w : world) (es : list event) : Prop :=
  match es with [] => True | e :: es => possible G D w e /\ all_possible G D (after G w e) es end.

(** * The invariant of the code's memory *)

Record sound (G : guard) (m : memory) : Prop := {
  at_most_full : (account m <= capacity G)%Z;
  older_is_allowed : (Z.abs (older m) <= largest G)%Z;
  force_is_allowed : (Z.abs (force m) <= largest G)%Z;
  deficit_without_force : (account m < 0 -> force m = 0 /\ older m = 0)%Z;
  reserve_is_there : (0 <= account m -> reserve G (older m) <= account m)%Z;
  force_is_paid :
    (0 <= account m -> Z.abs (force m) <= largest_force G (account m - reserve G (older m)))%Z
}.

Lemma Zle_Q (a b : Z) : (a <= b)%Z -> a <= b.
Proof. rewrite <- Zle_Qle. trivial. Qed.

Lemma minus_Q (a b : Z) : inject_Z (a - b) == a - b.
Proof. unfold Z.sub. rewrite inject_Z_plus, inject_Z_opp. reflexivity. Qed.

Lemma abs_Q (a : Z) : inject_Z (Z.abs a) == Qabs a.
Proof. unfold Qabs, inject_Z. reflexivity. Qed.

Ltac in_Q H :=
  repeat (first [rewrite inject_Z_plus in H | rewrite inject_Z_mult in H | rewrite minus_Q in H | rewrite inject_Z_opp in H]).

Lemma Qabs_bounds (x b : Q) : Qabs x <= b <-> - b <= x <= b.
Proof. apply Qabs_Qle_condition. Qed.

Lemma product_within (x y a b : Q) : - a <= x <= a -> - b <= y <= b -> - (a * b) <= x * y <= a * b.
Proof. intros [H1 H2] [H3 H4]. split; nra. Qed.

Lemma largest_force_monotone (G : guard) (a b : Z) :
  (0 <= per_reach G)%Z -> (a <= b)%Z -> (largest_force G a <= largest_force G b)%Z.
Proof.
  intros Hp H. unfold largest_force, gain_one, signal_one.
  apply Z.div_le_mono; [reflexivity|].
  apply Z.mul_le_mono_nonneg_l; [exact Hp|].
  apply Z.div_le_mono; [reflexivity | exact H].
Qed.

Lemma largest_force_nonneg (G : guard) (a : Z) :
  (0 <= per_reach G)%Z -> (0 <= a)%Z -> (0 <= largest_force G a)%Z.
Proof.
  intros Hp H. unfold largest_force, gain_one, signal_one.
  apply Z.div_pos; [|reflexivity]. apply Z.mul_nonneg_nonneg; [exact Hp|].
  apply Z.div_pos; [exact H | reflexivity].
Qed.

(** The largest force is rounded down. So over the reach, whose reciprocal is stored, its work is at most the energy [a]. *)
Lemma force_pays (G : guard) (f a : Z) (reach : Q) :
  (0 <= per_reach G)%Z -> (0 <= a)%Z -> 0 <= reach -> per_reach G * reach <= gain_one * signal_one ->
  (Z.abs f <= largest_force G a)%Z -> Z.abs f * reach <= a.
Proof.
  intros Hp Ha Hr Hc Hf.
  assert (H : (Z.abs f * (gain_one * signal_one) <= per_reach G * a)%Z).
  { unfold largest_force in Hf.
    assert (A1 : (gain_one * (per_reach G * (a / signal_one) / gain_one) <= per_reach G * (a / signal_one))%Z)
      by (apply Z.mul_div_le; reflexivity).
    assert (A2 : (signal_one * (a / signal_one) <= a)%Z) by (apply Z.mul_div_le; reflexivity).
    assert (A3 : (0 <= a / signal_one)%Z) by (apply Z.div_pos; [exact Ha | reflexivity]).
    set (p := per_reach G) in *. set (b := (a / signal_one)%Z) in *. set (q := (p * b / gain_one)%Z) in *.
    assert (B1 : (0 < signal_one)%Z) by reflexivity.
    assert (C1 : (Z.abs f * gain_one <= p * b)%Z) by (assert (0 < gain_one)%Z by reflexivity; nia).
    assert (C2 : (Z.abs f * gain_one * signal_one <= p * b * signal_one)%Z) by nia.
    assert (C3 : (p * (signal_one * b) <= p * a)%Z) by nia.
    nia. }
  apply Zle_Q in H. rewrite !inject_Z_mult in H.
  assert (P : 0 < gain_one * signal_one) by reflexivity.
  apply (cancel (gain_one * signal_one)); [exact P|].
  assert (F : 0 <= Z.abs f) by (change 0 with (inject_Z 0); apply Zle_Q; lia).
  assert (A : 0 <= a) by (change 0 with (inject_Z 0); apply Zle_Q; lia).
  assert (H2 : reach * (Z.abs f * (gain_one * signal_one)) <= reach * (per_reach G * a)) by nra.
  assert (H3 : a * (per_reach G * reach) <= a * (gain_one * signal_one)) by nra.
  lra.
Qed.

Section Covered.

Variables (G : guard) (D : device).
Hypothesis Cover : covers G D.

Definition reach : Q := (1 - s D) * d D + in_flight G + delta D * (1 # 2).

Lemma Q_nonneg (z : Z) : (0 <= z)%Z -> 0 <= z.
Proof. intros. change 0 with (inject_Z 0). apply Zle_Q. assumption. Qed.

Lemma in_flight_nonneg : (0 <= in_flight G)%Z.
Proof.
  destruct Cover. rewrite Zle_Qle. change (inject_Z 0) with 0.
  assert (0 <= s D * d D) by (apply times_nonneg; lra). lra.
Qed.

Lemma reach_at_least : in_flight G <= reach.
Proof.
  destruct Cover. unfold reach.
  assert (0 <= (1 - s D) * d D) by (apply times_nonneg; lra). lra.
Qed.

Lemma reach_nonneg : 0 <= reach.
Proof. pose proof reach_at_least. pose proof (Q_nonneg _ in_flight_nonneg). lra. Qed.

(** A force that the energy [a] allows has a reserve of at most [a]. *)
Lemma reserve_of_paid (f a : Z) :
  (0 <= a)%Z -> (Z.abs f <= largest_force G a)%Z -> (reserve G f <= a)%Z.
Proof.
  intros Ha Hf. destruct Cover. unfold reserve.
  pose proof (force_pays G f a reach per_reach_nonneg0 Ha reach_nonneg reach_covers0 Hf) as P.
  rewrite Zle_Qle, inject_Z_mult.
  assert (0 <= Z.abs f) by (apply Q_nonneg; lia).
  pose proof reach_at_least. nra.
Qed.

Lemma within_bounds (x l : Z) : (0 <= l)%Z -> (Z.abs (within x l) <= l)%Z.
Proof. unfold within. lia. Qed.

Lemma damped_nonneg (x : Z) : (0 <= damped G x)%Z.
Proof.
  destruct Cover. unfold damped.
  apply Z.mul_nonneg_nonneg; [|lia]. apply Z.div_pos; [|reflexivity]. apply Z.mul_nonneg_nonneg; lia.
Qed.

Lemma commanded_sound (m : memory) (told : Z) : sound G m -> sound G (commanded m told).
Proof.
  intros []. pose proof (within_bounds told (Z.abs (force m)) ltac:(lia)).
  constructor; cbn; auto; intros; try lia.
  all: unfold within in *; lia.
Qed.

Lemma tick_sound (m : memory) (moved before wanted : Z) : sound G m -> sound G (fst (tick G m moved before wanted)).
Proof.
  intros Hs. pose proof Hs as Hs'. destruct Hs. pose proof Cover as K. destruct K.
  assert (L0 : (0 <= largest G)%Z) by (apply largest_force_nonneg; assumption).
  unfold tick. destruct (_ || _) eqn:Fast; [|destruct (account m <? 0)%Z eqn:Deficit].
  - (* overspeed *)
    assert (0 <= lost G m)%Z.
    { unfold lost, highest_signal. apply Z.mul_nonneg_nonneg; [lia|].
      assert (0 <= overrun G * Z.max (Z.abs (force m)) (Z.abs (older m)) / signal_one)%Z
        by (apply Z.div_pos; [apply Z.mul_nonneg_nonneg; lia | reflexivity]).
      lia. }
    constructor; cbn; intros; try lia.
    apply largest_force_nonneg; [assumption|]. unfold reserve. lia.
  - (* an account that is negative *)
    apply Z.ltb_lt in Deficit.
    constructor; cbn; intros; try lia.
    apply largest_force_nonneg; [assumption|]. unfold reserve. lia.
  - (* ordinary *)
    apply Z.ltb_ge in Deficit.
    set (fr := free G m moved before).
    assert (F0 : (0 <= fr)%Z) by (unfold fr, free; lia).
    assert (R : (reserve G (force m) <= account m - reserve G (older m))%Z).
    { apply reserve_of_paid; [|auto]. specialize (reserve_is_there0 Deficit). lia. }
    assert (R0 : (0 <= reserve G (older m))%Z)
      by (unfold reserve; apply Z.mul_nonneg_nonneg; [lia | exact in_flight_nonneg]).
    assert (R1 : (0 <= reserve G (force m))%Z)
      by (unfold reserve; apply Z.mul_nonneg_nonneg; [lia | exact in_flight_nonneg]).
    assert (F1 : (fr <= capacity G - reserve G (force m))%Z) by (unfold fr, free; lia).
    assert (W : (Z.abs (within wanted (largest_force G fr)) <= largest_force G fr)%Z)
      by (apply within_bounds, largest_force_nonneg; assumption).
    constructor; cbn; fold fr; intros; try lia.
    + assert (M : (largest_force G fr <= largest_force G (capacity G))%Z) by (apply largest_force_monotone; lia).
      unfold largest. lia.
    + replace (fr + reserve G (force m) - reserve G (force m))%Z with fr by lia. lia.
Qed.

Lemma switched_off_sound (m : memory) : sound G m -> sound G (switched_off G m).
Proof.
  intros []. pose proof in_flight_nonneg. destruct Cover.
  assert (0 <= reserve G (older m))%Z by (unfold reserve; apply Z.mul_nonneg_nonneg; lia).
  assert (0 <= largest G)%Z by (apply largest_force_nonneg; assumption).
  constructor; cbn [switched_off account force older]; change (Z.abs 0) with 0%Z; try lia.
  - destruct (force m =? 0)%Z; lia.
  - unfold reserve. cbn. lia.
  - intros. apply largest_force_nonneg; [assumption|]. change (reserve G 0) with 0%Z. lia.
Qed.

(** * The account is a lower bound of the energy taken *)

(** In one tick the guard's sum grows by at most the energy that the port takes. [u] is the displacement that the code counts
    under the old force, rounded by up to a quantum. *)
Lemma books_of_a_tick (x b u g a f1 f2 under early rest taken_out e e' m damped sigma stray' after' charge L : Q) :
  acts_late (c D) (s D) (d D) (kappa D) under early rest taken_out ->
  x == early + rest + e - e' ->
  g == f1 - f2 -> a == Qabs g -> a <= 2 * L ->
  - (delta D * (1 # 2)) <= e <= delta D * (1 # 2) -> - (delta D * (1 # 2)) <= e' <= delta D * (1 # 2) ->
  - after' <= x - b <= after' ->
  - (delta D * (1 # 2) + rough D) <= e + under - (b + r D * (x - b)) <= delta D * (1 # 2) + rough D ->
  b + sigma * (x - b) + stray' * g - 1 <= u <= b + sigma * (x - b) + stray' * g ->
  0 <= m -> (m <= 0 \/ m + delta D <= x \/ m + delta D <= - x) -> damped <= c D * (m * m) ->
  delta D * (1 # 2) + rough D + 1 + Qabs (r D - sigma) * after' + Qmax 0 (kappa D - stray') * (2 * L) <= charge ->
  f1 * x - g * u - a * charge + damped + f1 * e' - f2 * e <= f2 * early + f1 * rest + taken_out.
Proof.
  intros Late Ex Eg Ea HL He He' Hx Hb Hu Hm Hd Hdamp Hcharge.
  pose proof Cover as K. destruct K.
  set (X := early + rest).
  assert (EX : X == x + e' - e) by (unfold X; lra).
  pose proof (straying_is_paid _ _ _ _ _ _ _ _ Late g) as Change.
  fold X in Change.
  assert (Ha : - a <= g <= a).
  { rewrite Ea. apply Qabs_bounds. apply Qle_refl. }
  assert (A0 : 0 <= a) by lra.
  (* the damping dissipates this: the true displacement is at most delta shorter than measured *)
  assert (Damp : damped <= c D * (X * X)).
  { apply Qle_trans with (c D * (m * m)); [exact Hdamp|].
    assert (m * m <= X * X); [|apply scaled; assumption].
    destruct Hd as [H|[H|H]].
    - assert (Z0 : m == 0) by lra. rewrite Z0. pose proof (square_nonneg X). lra.
    - assert (L1 : m <= X) by lra. pose proof (scaled m m X Hm L1). assert (X0 : 0 <= X) by lra.
      pose proof (scaled X m X X0 L1). lra.
    - assert (L1 : m <= - X) by lra. pose proof (scaled m m (- X) Hm L1). assert (X0 : 0 <= - X) by lra.
      pose proof (scaled (- X) m (- X) X0 L1). lra. }
  (* the rounding of the part under the old force *)
  assert (Round : - (g * u) <= - (g * (b + sigma * (x - b) + stray' * g)) + a).
  { assert (B : - (1) <= u - (b + sigma * (x - b) + stray' * g) <= 1) by lra.
    pose proof (product_within g (u - (b + sigma * (x - b) + stray' * g)) a 1 Ha B). lra. }
  (* [late] as stored, in place of r *)
  assert (Share : g * ((r D - sigma) * (x - b)) <= a * (Qabs (r D - sigma) * after')).
  { assert (B : - Qabs (r D - sigma) <= r D - sigma <= Qabs (r D - sigma)).
    { apply Qabs_bounds. apply Qle_refl. }
    pose proof (product_within _ _ _ _ B Hx) as B2.
    pose proof (product_within _ _ _ _ Ha B2). lra. }
  (* [stray] as stored, in place of kappa *)
  assert (Stray : (kappa D - stray') * (g * g) <= a * (Qmax 0 (kappa D - stray') * (2 * L))).
  { set (rr := Qmax 0 (kappa D - stray')).
    assert (R0 : 0 <= rr) by apply Q.le_max_l.
    assert (R1 : kappa D - stray' <= rr) by apply Q.le_max_r.
    assert (GG : g * g <= a * (2 * L)).
    { pose proof (product_within g g a a Ha Ha). pose proof (scaled a a (2 * L) A0 HL). lra. }
    pose proof (square_nonneg g) as G0.
    pose proof (scaled (g * g) _ _ G0 R1). pose proof (scaled rr _ _ R0 GG).
    lra. }
  (* half a count *)
  assert (Half : g * (e + under - (b + r D * (x - b))) <= a * (delta D * (1 # 2) + rough D))
    by (pose proof (product_within _ _ _ _ Ha Hb); lra).
  (* all charges together *)
  assert (Charge : a * (delta D * (1 # 2) + rough D) + a + a * (Qabs (r D - sigma) * after')
                   + a * (Qmax 0 (kappa D - stray') * (2 * L)) <= a * charge)
    by (pose proof (scaled a _ _ A0 Hcharge); lra).
  assert (Eport : f2 * early + f1 * rest + taken_out == f1 * X + (taken_out - g * early))
    by (unfold X; rewrite Eg; ring).
  rewrite Eport.
  assert (E1 : f1 * X == f1 * x + f1 * e' - f1 * e) by (rewrite EX; ring).
  assert (E2 : f1 * e == g * e + f2 * e) by (rewrite Eg; ring).
  lra.
Qed.

(** The energy that the code counts for damping is at most what the device's damping dissipates, in spite of rounding. *)
Lemma damped_is_there (x : Z) :
  let m := Z.max (Z.abs x - count G) 0 in
  0 <= m /\ (m <= 0 \/ m + delta D <= x \/ m + delta D <= - x) /\ damped G (Z.abs x) <= c D * (m * m).
Proof.
  pose proof Cover as K. destruct K. intros m.
  assert (M0 : (0 <= m)%Z) by (unfold m; lia).
  split; [apply Q_nonneg; exact M0|]. split.
  - destruct (Z_le_gt_dec (Z.abs x - count G) 0) as [L|L].
    + left. replace m with 0%Z by (unfold m; lia). apply Qle_refl.
    + right. assert (E : m = (Z.abs x - count G)%Z) by (unfold m; lia).
      rewrite E, minus_Q.
      destruct (Z_le_gt_dec 0 x) as [P|P].
      * left. rewrite Z.abs_eq by lia. lra.
      * right. rewrite Z.abs_neq, inject_Z_opp by lia. lra.
  - unfold damped. fold m. rewrite inject_Z_mult.
    set (q := (damping G * m / gain_one)%Z).
    assert (H : (gain_one * q <= damping G * m)%Z) by (apply Z.mul_div_le; reflexivity).
    apply Zle_Q in H. rewrite !inject_Z_mult in H.
    assert (M : 0 <= m) by (apply Q_nonneg; exact M0).
    assert (P : 0 < gain_one) by reflexivity.
    assert (H2 : damping G * m <= c D * gain_one * m) by nra.
    assert (H3 : q <= c D * m) by (apply (cancel gain_one); [exact P | lra]).
    nra.
Qed.

(** The invariant at a sample. [total] is the energy at the window's beginning, plus what the port took since and the refill. It
    is never negative, and the account and the energy of the position error are together at most [total]. *)
Record worth (w : world) (total : Q) : Prop := {
  nothing_lost : 0 <= total;
  account_is_there : account (memory_of w) + older (memory_of w) * error w <= total;
  memory_is_sound : sound G (memory_of w);
  error_is_small : Qabs (error w) <= delta D * (1 # 2)
}.

(** [total] also covers what the hand can get until any instant up to the next sample. *)
Lemma nothing_lost_within (w : world) (total early rest damped : Q) :
  worth w total -> Qabs early <= s D * d D -> Qabs rest <= (1 - s D) * d D -> 0 <= damped ->
  let m := memory_of w in
  0 <= total + older m * early + force m * rest + damped /\
  ((0 <= account m)%Z ->
   Z.abs (force m) * (in_flight G + delta D * (1 # 2)) <= total + older m * early + force m * rest + damped).
Proof.
  intros [N A Sd E] He Hr Hd m. fold m in A, Sd. destruct Sd. pose proof Cover as K. destruct K.
  destruct (Z_lt_le_dec (account m) 0) as [L|L].
  - destruct (deficit_without_force0 L) as [F O]. rewrite F, O. change (inject_Z 0) with 0.
    split; [lra|intros; lia].
  - specialize (reserve_is_there0 L). specialize (force_is_paid0 L).
    set (left := (account m - reserve G (older m))%Z) in *.
    assert (L0 : (0 <= left)%Z) by (unfold left; lia).
    pose proof (force_pays G (force m) left reach per_reach_nonneg0 L0 reach_nonneg reach_covers0 force_is_paid0) as Paid.
    assert (EL : account m == left + Z.abs (older m) * in_flight G).
    { unfold left, reserve. rewrite minus_Q, inject_Z_mult. ring. }
    rewrite !abs_Q in *.
    set (f := inject_Z (force m)) in *. set (o := inject_Z (older m)) in *.
    assert (Bo : - Qabs o <= o <= Qabs o) by (apply Qabs_bounds, Qle_refl).
    assert (Bf : - Qabs f <= f <= Qabs f) by (apply Qabs_bounds, Qle_refl).
    apply Qabs_bounds in He, Hr, E.
    pose proof (product_within _ _ _ _ Bo He) as P1.
    pose proof (product_within _ _ _ _ Bf Hr) as P2.
    pose proof (product_within _ _ _ _ Bo E) as P3.
    assert (O0 : 0 <= Qabs o) by lra. assert (F0 : 0 <= Qabs f) by lra.
    assert (P4 : Qabs o * (s D * d D + delta D * (1 # 2)) <= Qabs o * in_flight G) by nra.
    assert (P5 : Qabs f * reach == Qabs f * ((1 - s D) * d D) + Qabs f * (in_flight G + delta D * (1 # 2)))
      by (unfold reach; ring).
    assert (Z0 : 0 <= in_flight G) by (apply Q_nonneg, in_flight_nonneg).
    assert (P6 : 0 <= Qabs f * (in_flight G + delta D * (1 # 2))) by (apply times_nonneg; lra).
    split; [|intros _]; lra.
Qed.

Lemma worth_after (w : world) (total : Q) (e : event) :
  worth w total -> possible G D w e ->
  worth (after G w e) (total + port (memory_of w) e + refill G).
Proof.
  intros Wo Po. pose proof Cover as K. destruct K.
  assert (P0 : 0 <= refill G) by (apply Q_nonneg; assumption).
  destruct e as [under early rest out e' moved before wanted told | early rest out e' | dmp e'].
  2: { destruct Po as (Be & Br & Hd & He').
       pose proof (nothing_lost_within w total early rest out Wo Be Br Hd) as [Within _]; cbn in Within.
       destruct Wo as [N A Sd E]. constructor; cbn [after memory_of error port]; try assumption.
       - lra.
       - cbn [switched_off account older]. set (m := memory_of w) in *.
         change (inject_Z 0) with 0. destruct (Z.eqb_spec (force m) 0) as [F|F].
         + rewrite F in *. change (inject_Z 0) with 0 in *. rewrite minus_Q. unfold reserve. rewrite inject_Z_mult, abs_Q.
           set (o := inject_Z (older m)) in *.
           assert (Bo : - Qabs o <= o <= Qabs o) by (apply Qabs_bounds, Qle_refl).
           apply Qabs_bounds in E, Be.
           pose proof (product_within _ _ _ _ Bo Be) as P1. pose proof (product_within _ _ _ _ Bo E) as P2.
           assert (O0 : 0 <= Qabs o) by lra.
           assert (P3 : Qabs o * (s D * d D + delta D * (1 # 2)) <= Qabs o * in_flight G) by nra.
           lra.
         + assert (Min : Z.min (account m) 0 <= inject_Z 0) by (apply Zle_Q; lia). change (inject_Z 0) with 0 in Min. lra.
       - apply switched_off_sound; assumption. }
  2: { destruct Po as (F & O & Hd & He). destruct Wo as [N A Sd E]. cbn in *.
       rewrite O in A. constructor; cbn; try assumption; [lra|].
       rewrite O. change (inject_Z 0) with 0 in *. lra. }
  destruct Po as (Late & Be' & Ex & Slow & SlowB & Far & Told). pose proof Late as [Hd Be Br _].
  pose proof (nothing_lost_within w total early rest out Wo Be Br Hd) as [Within Next]; cbn in Within, Next.
  destruct Wo as [N A Sd E].
  set (m := memory_of w) in *.
  assert (Sound' : sound G (commanded (fst (tick G m moved before wanted)) told)) by (apply commanded_sound, tick_sound, Sd).
  assert (Nonneg : 0 <= total + port m (Tick under early rest out e' moved before wanted told) + refill G) by (cbn; lra).
  constructor; cbn [after memory_of error]; try assumption.
  fold m. cbn [commanded account older port].
  apply Qabs_bounds in E. pose proof Be' as Be2. apply Qabs_bounds in Be2.
  apply Qabs_bounds in Far, Told.
  pose proof (damped_is_there moved) as (M0 & Mx & Md).
  set (mm := Z.max (Z.abs moved - count G) 0) in *.
  set (sigma := late G / signal_one) in *. set (stray' := stray G / signal_one) in *.
  assert (L0 : 0 <= largest G) by (apply Q_nonneg, largest_force_nonneg; assumption).
  unfold tick.
  assert (S1 : (furthest G <? Z.abs moved)%Z = false) by (apply Z.ltb_ge; assumption).
  assert (S2 : (furthest G <? Z.abs before)%Z = false) by (apply Z.ltb_ge; assumption).
  rewrite S1, S2. cbn [orb].
  destruct (account m <? 0)%Z eqn:Deficit; cbn [fst make_up ordinary account older].
  - (* a negative account: no force acts *)
    apply Z.ltb_lt in Deficit. destruct Sd. destruct (deficit_without_force0 Deficit) as [F O].
    rewrite F, O in *. change (inject_Z 0) with 0 in *.
    set (u0 := before + sigma * (moved - before)).
    assert (B : 0 * moved - 0 * u0 - 0 * slack G + damped G (Z.abs moved) + 0 * e' - 0 * error w
                <= 0 * early + 0 * rest + out).
    { apply (books_of_a_tick moved before u0 0 0 0 0 under early rest out (error w) e' mm
               (damped G (Z.abs moved)) sigma stray' (way_after D) (slack G) (largest G)); try assumption; try reflexivity;
        unfold u0; lra. }
    assert (Min : Z.min (account m + refill G + damped G (Z.abs moved)) (capacity G)
                  <= inject_Z (account m + refill G + damped G (Z.abs moved))) by (apply Zle_Q; lia).
    rewrite !inject_Z_plus in Min. lra.
  - (* an ordinary tick: sum and reserve *)
    apply Z.ltb_ge in Deficit. specialize (Next Deficit).
    set (change := (force m - older m)%Z).
    set (v := ((late G * (moved - before) + stray G * change) / signal_one)%Z).
    set (u := (before + v)%Z).
    assert (Eu : under_older G moved before change = u) by reflexivity.
    assert (Hu : before + sigma * (moved - before) + stray' * change - 1 <= u <= before + sigma * (moved - before) + stray' * change).
    { assert (Hs : (0 < signal_one)%Z) by reflexivity.
      pose proof (Z.mul_div_le (late G * (moved - before) + stray G * change) signal_one Hs) as U1.
      pose proof (Z.mul_succ_div_gt (late G * (moved - before) + stray G * change) signal_one Hs) as U2.
      fold v in U1, U2.
      assert (U3 : (late G * (moved - before) + stray G * change <= signal_one * v + signal_one)%Z) by lia.
      apply Zle_Q in U1, U3. in_Q U1. in_Q U3.
      assert (P : 0 < signal_one) by reflexivity.
      assert (E1 : signal_one * (sigma * (moved - before) + stray' * change) == late G * (moved - before) + stray G * change).
      { unfold sigma, stray'. field. discriminate. }
      assert (EU : inject_Z u == inject_Z before + inject_Z v) by (unfold u; rewrite inject_Z_plus; reflexivity).
      assert (V : sigma * (moved - before) + stray' * change - 1 <= v <= sigma * (moved - before) + stray' * change)
        by (split; apply (cancel signal_one); try exact P; lra).
      lra. }
    assert (Eg : inject_Z change == force m - older m) by (unfold change; apply minus_Q).
    assert (Ha : Z.abs change <= 2 * largest G).
    { assert (H : (Z.abs change <= 2 * largest G)%Z) by (destruct Sd; unfold change; lia).
      apply Zle_Q in H. rewrite inject_Z_mult in H. exact H. }
    assert (B : force m * moved - change * u - Z.abs change * slack G + damped G (Z.abs moved)
                + force m * e' - older m * error w <= older m * early + force m * rest + out).
    { apply (books_of_a_tick moved before u change (Z.abs change) (force m) (older m) under early rest out (error w) e' mm
               (damped G (Z.abs moved)) sigma stray' (way_after D) (slack G) (largest G)); try assumption.
      apply abs_Q. }
    (* the account is the sum or the capacity, whichever is less, but at least the reserve *)
    unfold free. set (sum := booked G m moved before). set (r := reserve G (force m)).
    assert (Esum : inject_Z sum == account m + refill G + force m * moved - change * u - Z.abs change * slack G
                                   + damped G (Z.abs moved)).
    { unfold sum, booked. fold change. rewrite Eu. repeat (first [rewrite inject_Z_plus | rewrite minus_Q | rewrite inject_Z_mult]). ring. }
    assert (Er : inject_Z r == Z.abs (force m) * in_flight G) by (unfold r, reserve; rewrite inject_Z_mult; reflexivity).
    destruct (Z_le_gt_dec (Z.min sum (capacity G)) r) as [Le|Gt].
    + replace (Z.max (Z.min sum (capacity G) - r) 0 + r)%Z with r by lia.
      rewrite Er, abs_Q in *.
      set (f := inject_Z (force m)) in *.
      assert (Bf : - Qabs f <= f <= Qabs f) by (apply Qabs_bounds, Qle_refl).
      pose proof (product_within _ _ _ _ Bf Be2) as P3. lra.
    + replace (Z.max (Z.min sum (capacity G) - r) 0 + r)%Z with (Z.min sum (capacity G)) by lia.
      assert (Min : Z.min sum (capacity G) <= inject_Z sum) by (apply Zle_Q; lia).
      lra.
Qed.

(** * Any window *)

Lemma worth_run (es : list event) (w : world) (total : Q) :
  worth w total -> all_possible G D w es ->
  worth (run G w es) (total + (taken (run G w es) - taken w) + refill G * inject_Z (Z.of_nat (length es))).
Proof.
  revert w total. induction es as [|e es IH]; intros w total Wo Po; cbn [run length].
  - assert (E : total + (taken w - taken w) + refill G * inject_Z (Z.of_nat 0) == total)
      by (change (inject_Z (Z.of_nat 0)) with 0; ring).
    destruct Wo. constructor; try assumption; rewrite E; assumption.
  - destruct Po as [P1 P2].
    pose proof (IH _ _ (worth_after w total e Wo P1) P2) as Wo'.
    assert (E : total + port (memory_of w) e + refill G + (taken (run G (after G w e) es) - taken (after G w e))
                + refill G * inject_Z (Z.of_nat (length es))
                == total + (taken (run G (after G w e) es) - taken w) + refill G * inject_Z (Z.of_nat (S (length es)))).
    { rewrite Nat2Z.inj_succ. unfold Z.succ. rewrite inject_Z_plus. cbn [after taken]. ring. }
    destruct Wo'. constructor; try assumption; rewrite <- E; assumption.
Qed.

(** What may have happened before the window: anything, overspeed included, except that position errors stay within their bound,
    and that [Away] has no force. *)
Definition may_precede (w : world) (e : event) : Prop :=
  match e with
  | Tick _ _ _ _ error' _ _ _ _ | Off _ _ _ error' => Qabs error' <= delta D * (1 # 2)
  | Away _ error' => force (memory_of w) = 0%Z /\ older (memory_of w) = 0%Z /\ Qabs error' <= delta D * (1 # 2)
  end.

Fixpoint all_may_precede (w : world) (es : list event) : Prop :=
  match es with [] => True | e :: es => may_precede w e /\ all_may_precede (after G w e) es end.

Lemma sound_always (es : list event) (w : world) :
  sound G (memory_of w) -> Qabs (error w) <= delta D * (1 # 2) -> all_may_precede w es ->
  sound G (memory_of (run G w es)) /\ Qabs (error (run G w es)) <= delta D * (1 # 2).
Proof.
  revert w. induction es as [|e es IH]; intros w Sd E P; [split; assumption|].
  destruct P as [P1 P2]. cbn [run]. apply IH; [| |exact P2].
  - destruct e; cbn; [apply commanded_sound, tick_sound; exact Sd | apply switched_off_sound; exact Sd | exact Sd].
  - destruct e; cbn; [exact P1 | exact P1 | apply P1].
Qed.

Lemma full_is_sound : sound G (full G).
Proof.
  destruct Cover. assert (0 <= largest G)%Z by (apply largest_force_nonneg; assumption).
  constructor; cbn; try lia; intros; apply largest_force_nonneg; try assumption. unfold reserve. lia.
Qed.

(** At power-up: a full account, no force. *)
Definition power_up (error0 : Q) : world := {| memory_of := full G; error := error0; taken := 0; ticks := 0 |}.

(** The theorem. It holds whatever happened before the window, whatever the hand does in it ([early], [rest], the errors), and for
    all forces that the law requests and that are finally commanded. From the window's beginning to any instant up to the sample
    after its last tick, the hand gets out at most

      C + P T n + |f| delta/2

    more than it put in. Energy that the trusted damping dissipates counts as taken from the hand. [f] is the older force in the
    memory at the window's beginning, which still acts at first. *)
Theorem any_window (error0 : Q) (before window : list event) (early rest damped : Q) :
  Qabs error0 <= delta D * (1 # 2) ->
  let begin := run G (power_up error0) before in
  let w := run G begin window in
  all_may_precede (power_up error0) before ->
  all_possible G D begin window ->
  Qabs early <= s D * d D -> Qabs rest <= (1 - s D) * d D -> 0 <= damped ->
  let port_took := taken w - taken begin + older (memory_of w) * early + force (memory_of w) * rest + damped in
  - port_took <= capacity G + refill G * inject_Z (Z.of_nat (length window))
                 + Z.abs (older (memory_of begin)) * (delta D * (1 # 2)).
Proof.
  intros E0 begin w Hb Hw He Hr Hd port_took.
  assert (B : sound G (memory_of begin) /\ Qabs (error begin) <= delta D * (1 # 2)).
  { apply sound_always; [apply full_is_sound | exact E0 | exact Hb]. }
  destruct B as [Sd E].
  pose proof Cover as K. destruct K.
  set (bound := capacity G + Z.abs (older (memory_of begin)) * (delta D * (1 # 2))).
  assert (W : worth begin bound).
  { assert (C0 : 0 <= capacity G) by (apply Q_nonneg; assumption).
    assert (A : account (memory_of begin) <= capacity G) by (apply Zle_Q; destruct Sd; assumption).
    set (o := older (memory_of begin)) in *.
    assert (EA : inject_Z (Z.abs o) == Qabs o) by apply abs_Q.
    assert (Bo : - Z.abs o <= o <= Z.abs o) by (rewrite EA; apply Qabs_bounds, Qle_refl).
    pose proof E as E2. apply Qabs_bounds in E2.
    pose proof (product_within _ _ _ _ Bo E2) as P.
    assert (0 <= Z.abs o * (delta D * (1 # 2))) by (apply times_nonneg; lra).
    constructor; try assumption; fold o; unfold bound; lra. }
  pose proof (worth_run window begin bound W Hw) as W2.
  destruct (nothing_lost_within _ _ early rest damped W2 He Hr Hd) as [F _].
  fold w in F. unfold port_took, bound in *. lra.
Qed.

(** The force that still acts when the window begins is at most the largest force of a full account. *)
Corollary any_window_by_settings (error0 : Q) (before window : list event) (early rest damped : Q) :
  Qabs error0 <= delta D * (1 # 2) ->
  let begin := run G (power_up error0) before in
  let w := run G begin window in
  all_may_precede (power_up error0) before ->
  all_possible G D begin window ->
  Qabs early <= s D * d D -> Qabs rest <= (1 - s D) * d D -> 0 <= damped ->
  let port_took := taken w - taken begin + older (memory_of w) * early + force (memory_of w) * rest + damped in
  - port_took <= capacity G + refill G * inject_Z (Z.of_nat (length window)) + largest G * (delta D * (1 # 2)).
Proof.
  intros E0 begin w Hb Hw He Hr Hd port_took.
  pose proof (any_window error0 before window early rest damped E0 Hb Hw He Hr Hd) as H. cbn zeta in H.
  fold begin w port_took in H.
  destruct (sound_always before (power_up error0) full_is_sound E0 Hb) as [Sd _]. fold begin in Sd. destruct Sd.
  apply Zle_Q in older_is_allowed0. destruct Cover.
  assert (Z.abs (older (memory_of begin)) * (delta D * (1 # 2)) <= largest G * (delta D * (1 # 2))) by nra.
  lra.
Qed.

End Covered.
