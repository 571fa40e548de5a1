(** The guard's theorem for all settings that [Guard::new] accepts, in joules and radians ([any_accepted_window]). *)

Require Import ZArith QArith Qabs Lqa Lia List.
From Touchstone Require Import Guard Port GuardLosesNothing GuardSettings AcceptedIsValid AcceptedCovers.
Open Scope Q_scope.

(** A quantum of energy is 2^-48 J. A setting is an integer in units of 2^-32 of its SI unit. *)
Definition joules (quanta : Q) : Q := quanta / inject_Z (2 ^ 48).
Definition si (x : Z) : Q := inject_Z x / inject_Z si_one.

(** The theorem's bound, expressed by the settings. The largest force costs at most the capacity over the whole reach, so over
    half a count it costs a fraction of the capacity. *)
Lemma bound_in_settings {S : settings} {T : told} {Fits : fitting} (n : Q) :
  0 <= n ->
  let error := si (told_count T) / 2 + (1 # 2 ^ 24) in
  let way := si (set_overspeed S) / told_rate T in
  joules (capacity made + refill made * n + largest made * (delta (device_told S T) * (1 # 2)))
  <= si (set_capacity S) * (1 + error / (way + 2 * si (told_count T))) + si (set_refill S) / told_rate T * n.
Proof.
  intros N error way.
  destruct largest_made as (L0 & _ & L). destruct measured_within as [_ [_ M]].
  destruct refill_within as [_ P]. pose proof delta_exact as E.
  pose proof rate_pos as RP. pose proof (check_count checks) as [K _].
  pose proof (check_overspeed checks) as [O _]. assert (O' : (1 <= set_overspeed S)%Z) by lia.
  assert (C1 : capacity made == set_capacity S * 65536) by (rewrite capacity_made, inject_Z_mult; reflexivity).
  assert (C2 : refill made == refill_of * 65536) by (unfold made, energy_of; cbn [refill]; rewrite inject_Z_mult; reflexivity).
  unfold joules. rewrite C1, C2.
  set (l := largest made) in *. set (q := measured_of) in *. set (f := refill_of) in *. clearbody l q f.
  assert (L2 : (told_rate T * (2 ^ 8 * l * (q + 2 * told_count T + 784)) <= told_rate T * (set_capacity S * si_one))%Z)
    by (apply Z.mul_le_mono_nonneg_l; lia).
  assert (L3 : (2 ^ 8 * l * (set_overspeed S + 2 * told_rate T * told_count T) <= told_rate T * (set_capacity S * si_one))%Z).
  { assert (2 ^ 8 * l * (set_overspeed S + 2 * told_rate T * told_count T)
            <= 2 ^ 8 * l * (told_rate T * (q + 2 * told_count T + 784)))%Z by (apply Z.mul_le_mono_nonneg_l; lia). lia. }
  apply Zle_Q in L3, P, L0, K, O'. in_Q L3. in_Q P.
  assert (RQ : 0 < told_rate T) by (change 0 with (inject_Z 0); rewrite <- Zlt_Qlt; exact RP).
  set (r := inject_Z (told_rate T)) in *. set (k := inject_Z (told_count T)) in *. set (o := inject_Z (set_overspeed S)) in *.
  set (C := inject_Z (set_capacity S)) in *. set (ll := inject_Z l) in *.
  change (inject_Z (2 ^ 9)) with (512 # 1) in *. change (inject_Z (2 ^ 8)) with (256 # 1) in *. change (inject_Z 2) with 2 in *.
  change (inject_Z si_one) with (4294967296 # 1) in *. change (inject_Z 0) with 0 in *. change (inject_Z 1) with 1 in *.
  unfold si in *. fold k o C in way, error |- *. change (inject_Z si_one) with (4294967296 # 1) in *.
  change (inject_Z (2 ^ 48)) with (281474976710656 # 1).
  assert (RK : 0 <= r * k) by (apply times_nonneg; lra).
  set (w := way + 2 * (k / (4294967296 # 1))).
  assert (EW : (4294967296 # 1) * r * w == o + 2 * r * k) by (unfold w, way; field; lra).
  assert (W0 : 0 < w).
  { apply Qnot_le_lt. intros H. assert (r * w <= 0) by (setoid_replace 0 with (r * 0) by ring; apply scaled; lra). lra. }
  assert (LW : ll * w <= C * (1 # 256)).
  { apply (cancel ((256 # 1) * ((4294967296 # 1) * r))); [lra|].
    assert (X : (256 # 1) * ((4294967296 # 1) * r) * (ll * w) == (256 # 1) * ll * ((4294967296 # 1) * r * w)) by ring.
    rewrite X, EW. lra. }
  assert (EE : error == k * (1 # 8589934592) + (1 # 16777216)) by (unfold error; change (2 ^ 24)%positive with 16777216%positive; field).
  assert (E0 : 0 <= error) by lra.
  assert (LE : ll * error <= C * (1 # 256) * (error / w)).
  { assert (X : C * (1 # 256) * (error / w) == C * (1 # 256) * error / w) by (field; lra). rewrite X.
    apply Qle_shift_div_l; [exact W0|].
    pose proof (scaled error _ _ E0 LW). lra. }
  assert (ED : delta (device_told S T) * (1 # 2) == (16777216 # 1) * error) by lra.
  rewrite ED.
  assert (FN : inject_Z f * n <= inject_Z (set_refill S) / r * n).
  { apply Qmult_le_compat_r; [|exact N]. apply Qle_shift_div_l; [exact RQ | lra]. }
  set (x := error / w) in *.
  assert (X1 : inject_Z (set_refill S) / (4294967296 # 1) / r * n == inject_Z (set_refill S) / r * n * (1 # 4294967296)) by (field; lra).
  assert (X2 : C / (4294967296 # 1) == C * (1 # 4294967296)) by field.
  rewrite X1, X2. set (y := inject_Z (set_refill S) / r * n) in *.
  apply Qle_shift_div_r; [reflexivity|]. lra.
Qed.

(** In a window of [n] ticks, any hand gets out of a device that is no worse than described at most

      C (1 + e / (v T + 2 k)) + P T n

    with any law before the guard and whatever happened before the window. [C] and [P] are the settings of capacity and refill
    power, [k] is the encoder count, [e] half a count and a quantum, [v T] the displacement of a tick at the over-speed limit. *)
Theorem any_accepted_window (S : settings) (T : told) (G : guard) (D : device)
    (error0 : Q) (before window : list event) (early rest damped : Q) :
  accepted S T = Some G -> no_worse D (device_of S T) ->
  Qabs error0 <= delta D * (1 # 2) ->
  let begin := run G (power_up G error0) before in
  let w := run G begin window in
  all_may_precede G D (power_up G error0) before ->
  all_possible G D begin window ->
  Qabs early <= s D * d D -> Qabs rest <= (1 - s D) * d D -> 0 <= damped ->
  let port_took := taken w - taken begin + older (memory_of w) * early + force (memory_of w) * rest + damped in
  let error := si (told_count T) / 2 + (1 # 2 ^ 24) in
  let way := si (set_overspeed S) / told_rate T in
  joules (- port_took)
  <= si (set_capacity S) * (1 + error / (way + 2 * si (told_count T)))
     + si (set_refill S) / told_rate T * inject_Z (Z.of_nat (length window)).
Proof.
  intros A B E0 begin w Hb Hw He Hr Hd port_took error way.
  destruct (accepted_covers S T G A) as [K _]. pose proof (no_worse_is_covered _ _ _ K B) as KD.
  pose proof (any_window_by_settings G D KD error0 before window early rest damped E0 Hb Hw He Hr Hd) as H.
  cbn zeta in H. fold begin w port_took in H.
  apply accepted_made in A. destruct A as [F ->].
  assert (N : 0 <= inject_Z (Z.of_nat (length window))) by (apply Q_nonneg, Zle_0_nat).
  eapply Qle_trans; [|apply (bound_in_settings _ N)].
  unfold joules. apply Qmult_le_compat_r; [|discriminate].
  assert (L : 0 <= largest made) by (apply Q_nonneg; apply largest_made).
  destruct B as [_ _ _ _ _ _ [_ X] _].
  assert (Same : delta (device_of S T) == delta (device_told S T))
    by (unfold device_of; destruct (set_measured S); reflexivity).
  assert (largest made * (delta D * (1 # 2)) <= largest made * (delta (device_told S T) * (1 # 2)))
    by (apply scaled; [exact L | lra]).
  lra.
Qed.
