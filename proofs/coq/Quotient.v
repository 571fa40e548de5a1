(** Division by a power of two by repeated halving, once for each bit of the divisor. It is faster than [Z.div], and Extract.v
    uses it instead. *)

Require Import ZArith.
Open Scope Z_scope.

Fixpoint by_halves (a : Z) (p : positive) : option Z :=
  match p with
  | xH => Some a
  | xO p => by_halves (Z.div2 a) p
  | xI _ => None
  end.

Definition long_division (a b : Z) : Z := let (q, _) := Z.div_eucl a b in q.

Definition quotient (a b : Z) : Z :=
  match b with
  | Zpos p => match by_halves a p with Some q => q | None => long_division a b end
  | _ => long_division a b
  end.

Lemma by_halves_is_div (p : positive) (a q : Z) : by_halves a p = Some q -> q = a / Zpos p.
Proof.
  revert a. induction p as [p IH|p IH|]; intros a H; cbn in H.
  - discriminate.
  - apply IH in H. rewrite H, Z.div2_div, Z.div_div; [reflexivity | discriminate | reflexivity].
  - injection H as <-. symmetry. apply Z.div_1_r.
Qed.

Theorem quotient_is_div (a b : Z) : quotient a b = a / b.
Proof.
  unfold quotient. destruct b as [|p|p]; try reflexivity.
  destruct (by_halves a p) as [q|] eqn:H; [|reflexivity]. exact (by_halves_is_div p a q H).
Qed.
