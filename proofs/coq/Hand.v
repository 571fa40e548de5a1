(** The step from the motor's port to the hand. The guard bounds the energy that the port gives ([any_window]). A device with
    inertia also gives the kinetic energy that it has at the window's beginning. So a hand gets at most the port's bound and this
    kinetic energy, less the kinetic energy at the window's end.

    The motion is divided into moments, in each of which all torques are constant. A moment may be as short as one likes. In it
    Newton's law holds, so the speed changes evenly and the displacement is the mean speed times the time. No energy balance is
    assumed; it is proved ([hand_balance]). *)

Require Import ZArith QArith Qabs Lqa Lia List.
From Touchstone Require Import Guard Port GuardLosesNothing ToldChange GuardSettings AcceptedIsValid AcceptedCovers AcceptedWindow.
Import ListNotations.
Open Scope Q_scope.

(** * A device with inertia in a hand *)

(** A moment. Times are in ticks, angles and torques in quanta, speeds in quanta a tick. *)
Record moment : Set := {
  lasts : Q;      (* its length *)
  hand : Q;       (* torque of the hand, positive towards rising positions *)
  drag : Q;       (* torque of damping and friction, positive if it acts against rising positions *)
  still_old : Q;  (* fraction of the change of force that is still missing: 1 before the change, 0 after it *)
  speed : Q       (* speed at its end *)
}.

(** The displacement in a moment that begins with the speed [v]. *)
Definition way_in (v : Q) (m : moment) : Q := (v + speed m) * (1 # 2) * lasts m.

(** The motor's torque in a moment: the fraction [still_old] of the older force, and the rest of the last one. *)
Definition motor (older_ force_ : Q) (m : moment) : Q := older_ * still_old m + force_ * (1 - still_old m).

(** Newton's law in each moment for a device with the inertia [J], which begins with the speed [v]. Damping and friction only
    dissipate. *)
Fixpoint obeys (J older_ force_ v : Q) (ms : list moment) : Prop :=
  match ms with
  | [] => True
  | m :: ms =>
      J * (speed m - v) == (hand m - motor older_ force_ m - drag m) * lasts m
      /\ 0 <= drag m * way_in v m /\ obeys J older_ force_ (speed m) ms
  end.

(** The sum of a quantity of each moment, which may depend on the speed at its beginning; and the speed at the end. *)
Fixpoint along (of_ : Q -> moment -> Q) (v : Q) (ms : list moment) : Q :=
  match ms with [] => 0 | m :: ms => of_ v m + along of_ (speed m) ms end.
Fixpoint speed_after (v : Q) (ms : list moment) : Q :=
  match ms with [] => v | m :: ms => speed_after (speed m) ms end.

(** Energy that the hand puts in, energy that is dissipated, and the displacement's parts under the older and the last force. *)
Definition put_in : Q -> list moment -> Q := along (fun v m => hand m * way_in v m).
Definition dissipates : Q -> list moment -> Q := along (fun v m => drag m * way_in v m).
Definition old_way : Q -> list moment -> Q := along (fun v m => still_old m * way_in v m).
Definition new_way : Q -> list moment -> Q := along (fun v m => (1 - still_old m) * way_in v m).

Definition kinetic (J v : Q) : Q := (1 # 2) * J * (v * v).

(** The energy balance at the hand. *)
Theorem hand_balance (J older_ force_ v : Q) (ms : list moment) :
  obeys J older_ force_ v ms ->
  put_in v ms == older_ * old_way v ms + force_ * new_way v ms + dissipates v ms + kinetic J (speed_after v ms) - kinetic J v
  /\ 0 <= dissipates v ms.
Proof.
  unfold put_in, dissipates, old_way, new_way, kinetic.
  revert v. induction ms as [|m ms IH]; intros v H; cbn [along speed_after]; [split; lra|].
  destruct H as (N & D & H). destruct (IH _ H) as [E P]. split; [|lra].
  rewrite E. clear IH E P H D.
  assert (W : hand m * way_in v m
              == (motor older_ force_ m + drag m) * way_in v m + (1 # 2) * J * (speed m * speed m) - (1 # 2) * J * (v * v)).
  { assert (X : (hand m - motor older_ force_ m - drag m) * way_in v m
                == (hand m - motor older_ force_ m - drag m) * lasts m * ((v + speed m) * (1 # 2))) by (unfold way_in; ring).
    rewrite <- N in X.
    assert (Y : hand m * way_in v m
                == (hand m - motor older_ force_ m - drag m) * way_in v m + (motor older_ force_ m + drag m) * way_in v m) by ring.
    rewrite Y, X. ring. }
  rewrite W. unfold motor. ring.
Qed.

(** A damping of [c] over a tick: in a moment its torque is at least [c] times the mean speed, so it dissipates at least
    [c way^2 / lasts]. *)
Fixpoint is_damped (c v : Q) (ms : list moment) : Prop :=
  match ms with
  | [] => True
  | m :: ms =>
      0 <= lasts m /\ 0 <= drag m * way_in v m /\ c * (way_in v m * way_in v m) <= lasts m * (drag m * way_in v m)
      /\ is_damped c (speed m) ms
  end.

Definition time (v : Q) (ms : list moment) : Q := along (fun _ m => lasts m) v ms.

(** Such a damping dissipates enough in any part of a tick. This is the assumption [part_of_tick] of the guard's theorem. *)
Theorem drag_damps (c v : Q) (ms : list moment) :
  0 <= c -> is_damped c v ms -> part_of_tick c (time v ms) (along way_in v ms) (dissipates v ms) /\ 0 <= time v ms.
Proof.
  intros Hc. unfold dissipates, time. revert v. induction ms as [|m ms IH]; intros v H; cbn [along].
  - split; [constructor; [lra | lra | reflexivity] | lra].
  - destruct H as (T & D & E & R).
    destruct (IH (speed m) R) as [[D2 E2 N2] T'].
    set (t := lasts m) in *. set (t' := along (fun _ m => lasts m) (speed m) ms) in *.
    set (x := way_in v m) in *. set (x' := along way_in (speed m) ms) in *.
    set (d := drag m * x) in *. set (d' := along (fun v m => drag m * way_in v m) (speed m) ms) in *.
    assert (Z : t == 0 -> x == 0) by (intros Z; unfold x, way_in; fold t; rewrite Z; ring).
    assert (P1 : part_of_tick c t x d) by (constructor; assumption).
    assert (P2 : part_of_tick c t' x' d') by (constructor; assumption).
    clearbody t t' x x' d d'. split; [|lra].
    constructor; [lra | | intros S; assert (S1 : t == 0) by lra; assert (S2 : t' == 0) by lra; rewrite (Z S1), (N2 S2); ring].
    destruct (Qlt_le_dec 0 (t + t')) as [P|P].
    + set (q := (x + x') / (t + t')).
      pose proof (tangent c t x d q Hc T P1) as A1. pose proof (tangent c t' x' d' q Hc T' P2) as A2.
      assert (Q0 : q * (t + t') == x + x') by (unfold q; field; lra).
      assert (A : c * (2 * q * (x + x') - q * q * (t + t')) <= d + d') by lra.
      assert (A0 : 0 <= t + t') by lra.
      pose proof (scaled (t + t') _ _ A0 A) as B.
      assert (Y : (t + t') * (c * (2 * q * (x + x') - q * q * (t + t')))
                  == c * (2 * (q * (t + t')) * (x + x') - (q * (t + t')) * (q * (t + t')))) by ring.
      rewrite Y, Q0 in B. lra.
    + assert (S1 : t == 0) by lra. assert (S2 : t' == 0) by lra. rewrite (Z S1), (N2 S2), S1, S2. lra.
Qed.

(** * Events of the guard, with the motion that they are made of *)

(** The event's displacements are those of its moments. The event counts at most the energy that they dissipate. *)
Definition is_made_of (e : event) (v : Q) (ms : list moment) : Prop :=
  match e with
  | Tick _ early rest damped _ _ _ _ _ | Off early rest damped _ =>
      old_way v ms == early /\ new_way v ms == rest /\ damped <= dissipates v ms
  | Away damped _ => damped <= dissipates v ms
  end.

Fixpoint all_made_of (G : guard) (J : Q) (w : world) (v : Q) (es : list (event * list moment)) : Prop :=
  match es with
  | [] => True
  | (e, ms) :: es =>
      obeys J (older (memory_of w)) (force (memory_of w)) v ms /\ is_made_of e v ms
      /\ all_made_of G J (after G w e) (speed_after v ms) es
  end.

(** All moments of the events, one after the other. *)
Definition motion (es : list (event * list moment)) : list moment := flat_map snd es.

Lemma along_app (of_ : Q -> moment -> Q) (ms ms' : list moment) (v : Q) :
  along of_ v (ms ++ ms') == along of_ v ms + along of_ (speed_after v ms) ms'.
Proof. revert v. induction ms as [|m ms IH]; intros v; cbn [app along speed_after]; [ring | rewrite IH; ring]. Qed.

Lemma speed_after_app (ms ms' : list moment) (v : Q) : speed_after v (ms ++ ms') = speed_after (speed_after v ms) ms'.
Proof. revert v. induction ms as [|m ms IH]; intros v; cbn [app speed_after]; [reflexivity | apply IH]. Qed.

(** In a window the hand puts in at least what the port took, plus the growth of the kinetic energy. *)
Lemma put_in_at_least (G : guard) (D : device) (J : Q) (es : list (event * list moment)) (w : world) (v : Q) :
  all_possible G D w (map fst es) -> all_made_of G J w v es ->
  taken (run G w (map fst es)) - taken w + kinetic J (speed_after v (motion es)) - kinetic J v <= put_in v (motion es).
Proof.
  unfold put_in.
  revert w v. induction es as [|[e ms] es IH]; intros w v P M; cbn [map fst run motion flat_map snd speed_after along]; [lra|].
  destruct P as [P1 P2]. destruct M as (O & I & M).
  pose proof (IH (after G w e) (speed_after v ms) P2 M) as R. fold (motion es).
  rewrite along_app, speed_after_app.
  destruct (hand_balance _ _ _ _ _ O) as [B _]. unfold put_in in B. rewrite B.
  assert (H : port (memory_of w) e
              <= older (memory_of w) * old_way v ms + force (memory_of w) * new_way v ms + dissipates v ms).
  { destruct e; cbn [port is_made_of] in *.
    - destruct I as (I1 & I2 & I3). rewrite I1, I2. lra.
    - destruct I as (I1 & I2 & I3). rewrite I1, I2. lra.
    - destruct P1 as (F & Ol & _). rewrite F, Ol. change (inject_Z 0) with 0. lra. }
  cbn [after taken] in R. cbn [map fst] in *. lra.
Qed.

(** In any window the hand gets out at most the energy that the port gave and the kinetic energy at the beginning, less that at the
    end. The window ends at any instant: [last] are the moments since its last event. *)
Theorem hand_gets (G : guard) (D : device) (J v : Q) (w : world) (window : list (event * list moment)) (last : list moment) :
  all_possible G D w (map fst window) -> all_made_of G J w v window ->
  let w' := run G w (map fst window) in
  let v' := speed_after v (motion window) in
  obeys J (older (memory_of w')) (force (memory_of w')) v' last ->
  let port_took := taken w' - taken w + older (memory_of w') * old_way v' last + force (memory_of w') * new_way v' last
                   + dissipates v' last in
  let all := motion window ++ last in
  - put_in v all <= - port_took + kinetic J v - kinetic J (speed_after v all).
Proof.
  intros P M w' v' O port_took all.
  pose proof (put_in_at_least G D J window w v P M) as A. fold w' v' in A.
  destruct (hand_balance _ _ _ _ _ O) as [B _].
  unfold all, put_in in *. rewrite along_app, speed_after_app. fold v'. rewrite B. unfold port_took. lra.
Qed.

(** Kinetic energy in joules, of an inertia in kg m^2 and a speed in rad/s. In the theorem's units the inertia is multiplied by the
    control rate squared, and a speed is in quanta of 2^-24 rad a tick. *)
Definition inertia_of (T : told) (kg_m2 : Q) : Q := kg_m2 * (told_rate T * told_rate T).
Definition speed_of (T : told) (rad_per_s : Q) : Q := rad_per_s * inject_Z (2 ^ 24) / told_rate T.

Lemma kinetic_in_joules (T : told) (kg_m2 rad_per_s : Q) :
  (0 < told_rate T)%Z ->
  joules (kinetic (inertia_of T kg_m2) (speed_of T rad_per_s)) == (1 # 2) * kg_m2 * (rad_per_s * rad_per_s).
Proof.
  intros R. assert (0 < told_rate T) by (change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; exact R).
  unfold joules, kinetic, inertia_of, speed_of.
  change (inject_Z (2 ^ 48)) with (281474976710656 # 1). change (inject_Z (2 ^ 24)) with (16777216 # 1). field. lra.
Qed.

(** With any settings that [Guard::new] accepts, any law and any hand: in a window of [n] ticks the hand gets out at most the bound
    of [any_accepted_window] and the kinetic energy at the window's beginning,

      C (1 + e / (v T + 2 k)) + P T n + 1/2 J v0^2 *)
Theorem any_accepted_hand (S : settings) (T : told) (G : guard) (D : device) (kg_m2 rad_per_s : Q)
    (error0 : Q) (before : list event) (window : list (event * list moment)) (last : list moment) :
  accepted S T = Some G -> no_worse D (device_of S T) -> 0 <= kg_m2 ->
  Qabs error0 <= delta D * (1 # 2) ->
  let J := inertia_of T kg_m2 in
  let v := speed_of T rad_per_s in
  let begin := run G (power_up G error0) before in
  let w := run G begin (map fst window) in
  let v' := speed_after v (motion window) in
  all_may_precede G D (power_up G error0) before ->
  all_possible G D begin (map fst window) -> all_made_of G J begin v window ->
  obeys J (older (memory_of w)) (force (memory_of w)) v' last ->
  Qabs (old_way v' last) <= s D * d D -> Qabs (new_way v' last) <= (1 - s D) * d D ->
  let error := si (told_count T) / 2 + (1 # 2 ^ 24) in
  let way := si (set_overspeed S) / told_rate T in
  joules (- put_in v (motion window ++ last))
  <= si (set_capacity S) * (1 + error / (way + 2 * si (told_count T)))
     + si (set_refill S) / told_rate T * inject_Z (Z.of_nat (length window))
     + (1 # 2) * kg_m2 * (rad_per_s * rad_per_s).
Proof.
  intros A N I E0 J v begin w v' Hb Hw M O He Hr error way.
  destruct (hand_balance _ _ _ _ _ O) as [_ Hd].
  pose proof (any_accepted_window S T G D error0 before (map fst window) _ _ _ A N E0 Hb Hw He Hr Hd) as B.
  cbn zeta in B. fold begin w error way in B. rewrite map_length in B.
  pose proof (hand_gets G D J v begin window last Hw M O) as H. cbn zeta in H. fold w v' in H.
  assert (R : (0 < told_rate T)%Z) by (apply accepted_made in A; destruct A as [F _]; apply rate_pos).
  pose proof (kinetic_in_joules T kg_m2 rad_per_s R) as K. fold J v in K.
  set (all := motion window ++ last) in *.
  assert (K0 : 0 <= kinetic J (speed_after v all)).
  { unfold kinetic, J, inertia_of. pose proof (square_nonneg (speed_after v all)). pose proof (square_nonneg (told_rate T)).
    assert (0 <= kg_m2 * (told_rate T * told_rate T)) by (apply times_nonneg; assumption).
    assert (0 <= (1 # 2) * (kg_m2 * (told_rate T * told_rate T))) by lra.
    apply times_nonneg; assumption. }
  unfold joules in *. unfold Qdiv in *.
  set (k := / inject_Z (2 ^ 48)) in *. assert (K1 : 0 <= k) by (vm_compute; discriminate). clearbody k.
  rewrite <- K. clear K A N Hb Hw M O.
  set (took := taken w - taken begin + older (memory_of w) * old_way v' last + force (memory_of w) * new_way v' last
               + dissipates v' last) in *.
  set (x := kinetic J (speed_after v all)) in *. set (y := kinetic J v) in *. set (p := put_in v all) in *.
  clearbody took x y p.
  assert (Y : (- p) * k <= (- took) * k + y * k) by nra.
  lra.
Qed.
