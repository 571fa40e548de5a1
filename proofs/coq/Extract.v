(** The specification as a program: what compare.ml runs beside the shipped code's ticks. Integers stay Coq's own, of any size. *)

From Touchstone Require Import Guard.
Require Import ExtrOcamlBasic.
Extraction Language OCaml.
Extraction "guard_spec.ml" tick commanded full.
