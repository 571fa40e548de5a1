(** A guard may learn the position at the change of force, or must estimate which part of a displacement passed before the change.
    In both cases its error about the displacement under the old force is at most that of a position, and of rounding. The theorem
    requires this of a tick ([possible]). *)

Require Import ZArith QArith Qabs Lqa Lia.
From Touchstone Require Import Guard Port GuardLosesNothing.
Open Scope Q_scope.

Section Told.

Variables (G : guard) (D : device).
Hypothesis Shares : 0 <= r D <= 1.
Hypothesis Exact : 0 <= delta D /\ 0 <= rough D.

(** With one position a tick, the displacement under the old force is estimated as the fraction [s] of the whole. *)
Theorem once_a_tick (w : world) (early rest damped error' : Q) (moved wanted told : Z) :
  r D == s D -> inject_Z (furthest G) <= way_after D ->
  acts_late (c D) (s D) (d D) (kappa D) (s D * (early + rest)) early rest damped ->
  Qabs (error w) <= delta D * (1 # 2) -> Qabs error' <= delta D * (1 # 2) ->
  moved == early + rest + error w - error' -> (Z.abs moved <= furthest G)%Z ->
  possible G D w (Tick (s D * (early + rest)) early rest damped error' moved 0 wanted told).
Proof.
  intros Same Far Late E E' M Slow.
  assert (F : - inject_Z (furthest G) <= moved <= inject_Z (furthest G)).
  { assert (H : (- furthest G <= moved <= furthest G)%Z) by lia. destruct H as [H1 H2].
    apply Zle_Q in H1, H2. rewrite inject_Z_opp in H1. lra. }
  repeat split; try assumption; try lia; try apply Late.
  - apply Qabs_bounds. change (inject_Z 0) with 0. lra.
  - apply Qabs_bounds. apply Qabs_bounds in E, E'. change (inject_Z 0) with 0. rewrite Same in *.
    destruct Shares as [S0 S1]. assert (S2 : 0 <= 1 - s D) by lra.
    assert (X : error w + s D * (early + rest) - (0 + s D * (moved - 0)) == (1 - s D) * error w + s D * error')
      by (rewrite M; ring).
    rewrite X.
    pose proof (scaled _ _ _ S2 (proj1 E)). pose proof (scaled _ _ _ S2 (proj2 E)).
    pose proof (scaled _ _ _ S0 (proj1 E')). pose proof (scaled _ _ _ S0 (proj2 E')). lra.
Qed.

(** A second position is read within the tick, with its own error [read_error]. The device moves by [u] until this reading and by
    [v] after it. [h1] and [h2] are the mean fractions of the change of force that are still missing before and after the reading.

    The guard gets [before]. The fraction [1 - r] of the remaining displacement [moved - before] must be, up to the rounding
    [rough], the measured displacement weighted with the fractions [1 - h1] and [1 - h2] of the change that act. *)
Theorem read_in_between (w : world) (h1 h2 u v early rest damped read_error error' : Q) (moved before wanted told : Z) :
  0 <= h2 <= h1 -> h1 <= 1 ->
  early + rest == u + v ->
  acts_late (c D) (s D) (d D) (kappa D) (h1 * u + h2 * v) early rest damped ->
  Qabs (error w) <= delta D * (1 # 2) -> Qabs read_error <= delta D * (1 # 2) -> Qabs error' <= delta D * (1 # 2) ->
  moved == early + rest + error w - error' -> (Z.abs moved <= furthest G)%Z -> (Z.abs before <= furthest G)%Z ->
  Qabs (moved - before) <= way_after D ->
  let until_read := u + error w - read_error in
  let from_read := v + read_error - error' in
  Qabs ((1 - r D) * (moved - before) - ((1 - h1) * until_read + (1 - h2) * from_read)) <= rough D ->
  possible G D w (Tick (h1 * u + h2 * v) early rest damped error' moved before wanted told).
Proof.
  intros H2 H1 EX Late E Ec E' M Slow SlowB Far until_read from_read Round.
  repeat split; try assumption; try apply Late.
  apply Qabs_bounds. apply Qabs_bounds in E, Ec, E', Round.
  set (q := (1 - r D) * (moved - before)) in *.
  assert (X : error w + (h1 * u + h2 * v) - (before + r D * (moved - before))
              == (1 - h1) * error w + (h1 - h2) * read_error + h2 * error'
                 + (q - ((1 - h1) * until_read + (1 - h2) * from_read))).
  { assert (B : before + r D * (moved - before) == moved - q) by (unfold q; ring).
    rewrite B, M, EX. unfold until_read, from_read. ring. }
  rewrite X. clearbody q until_read from_read.
  assert (A1 : 0 <= 1 - h1) by lra. assert (A2 : 0 <= h1 - h2) by lra. assert (A3 : 0 <= h2) by lra.
  pose proof (scaled _ _ _ A1 (proj1 E)). pose proof (scaled _ _ _ A1 (proj2 E)).
  pose proof (scaled _ _ _ A2 (proj1 Ec)). pose proof (scaled _ _ _ A2 (proj2 Ec)).
  pose proof (scaled _ _ _ A3 (proj1 E')). pose proof (scaled _ _ _ A3 (proj2 E')). lra.
Qed.

End Told.
