(** The specification as a program: what compare.ml runs beside the shipped code's ticks, and beside what it makes of
    settings. Integers stay Coq's own, of any size. *)

From Touchstone Require Import Guard GuardSettings Laws Enhanced.
Require Import ExtrOcamlBasic.
Extraction Language OCaml.
Extraction "specified.ml" tick commanded full accepted tdpa_tick fba_tick outside enhanced_tick free_at.
