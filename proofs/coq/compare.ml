(* Reads ticks of the shipped code (examples/trace.rs) and runs the extracted specification on them: every memory and every result
   must be equal to the last bit. So must a guard's coefficients, the refusal of settings, and roots. *)

open Specified

let number = Big_int_Z.big_int_of_string
let zero = Big_int_Z.zero_big_int
let one = Big_int_Z.unit_big_int

type running =
  | Nothing
  | Of_settings of guard option
  | A_guard of guard * memory
  | A_tdpa of tdpa * observed
  | An_fba of fba * observed
  | An_enhanced of enhanced * state

let running = ref Nothing
let ticks = ref 0
let made = ref 0
let ended = ref 0
let allowed = ref 0
let refused = ref 0
let roots = ref 0

let fail line why = Printf.printf "after %d ticks: %s: %s\n" !ticks line why; exit 1
let check line same = if same then incr ticks else fail line "the specification says otherwise"
let settled count line same = if same then incr count else fail line "the specification says otherwise"

(* Counts the enhanced law's ticks in each of the situations that the traces must contain. *)
let seen = Array.make 7 0
let reached after m =
  let both = m.phase = Augmenting && after.phase = Augmenting in
  let less = Big_int_Z.lt_big_int in
  List.iteri
    (fun i it -> if it then seen.(i) <- seen.(i) + 1)
    [ m.phase = First && after.phase = Augmenting; m.phase = Augmenting && after.phase = Free;
      both && less m.offset after.offset; both && less after.offset m.offset; both && after.hip_force = zero;
      both && less after.left m.left; both && less after.last zero ]

let start it = incr made; running := it

let take line =
  match String.split_on_char ' ' line with
  | [] -> fail line "an empty line"
  | word :: texts -> (
      match (word, List.map number texts, !running) with
      | "settings",
        [ set_capacity; set_refill; set_share; set_damping; set_overspeed; set_delay; set_lag; measured; told_rate; told_limit;
          told_count ], _ ->
          let set_measured = measured <> zero in
          running :=
            Of_settings
              (made_of
                 { set_capacity; set_refill; set_share; set_damping; set_overspeed; set_delay; set_lag; set_measured }
                 { told_rate; told_limit; told_count })
      | "made", [ capacity; refill; damping; furthest; count; late; stray; slack; per_reach; in_flight; overrun ], Of_settings it ->
          settled allowed line
            (it = Some { capacity; refill; damping; furthest; count; late; stray; slack; per_reach; in_flight; overrun })
      | "refused", [], Of_settings it -> settled refused line (it = None)
      | "root_32", [ n; whole ], _ -> settled roots line (root_32 n = whole)
      | "root_high_32", [ n; high ], _ -> settled roots line (root_high_32 n = high)
      | "root_64", [ n; digits; whole ], _ -> settled roots line (root_by_digits n = digits && root_64 n = whole)
      | "root_high_64", [ n; high ], _ -> settled roots line (root_high_64 n = high)
      | "guard", [ capacity; refill; damping; furthest; count; late; stray; slack; per_reach; in_flight; overrun ], _ ->
          let it = { capacity; refill; damping; furthest; count; late; stray; slack; per_reach; in_flight; overrun } in
          start (A_guard (it, full it))
      | "tdpa", [ t_desired; form; t_damping; t_limit ], _ ->
          start (A_tdpa ({ t_desired; exact = form <> zero; t_damping; t_limit }, outside))
      | "fba", [ f_desired; f_damping; f_limit ], _ -> start (An_fba ({ f_desired; f_damping; f_limit }, outside))
      | "enhanced",
        [ desired; target; soft; compliance; of_ideal; of_force; of_penetration; hip; every; exact; keep; inertia; coupling;
          mass_damping; total; series; credit; limit ], _ ->
          let at_hip = hip <> zero and every_tick = every <> zero and mass_exact = exact <> zero and keep_force = keep <> zero in
          let it =
            { desired; target; soft; compliance; of_ideal; of_force; of_penetration; at_hip; every_tick; mass_exact; keep_force;
              inertia; coupling; mass_damping; total; series; credit; limit }
          in
          start (An_enhanced (it, free_at zero))
      | "tick", [ moved; before; wanted; told; account'; force'; older'; fine; told' ], A_guard (it, m) ->
          let after, answer = tick it m moved before wanted in
          let last = commanded after told in
          check line
            (after.account = account' && after.force = force' && after.older = older'
            && answer = (fine <> zero) && last.force = told');
          running := A_guard (it, last)
      | "off", [ account'; force'; older' ], A_guard (it, m) ->
          let after = switched_off it m in
          settled ended line (after = { account = account'; force = force'; older = older' });
          running := A_guard (it, after)
      | "law", [ e; moved; force'; energy' ], A_tdpa (it, m) ->
          let after = tdpa_tick it m e moved in
          check line (after.shown = force' && after.energy = energy');
          running := A_tdpa (it, after)
      | "law", [ e; moved; force'; energy' ], An_fba (it, m) ->
          let after = fba_tick it m e moved in
          check line (after.shown = force' && after.energy = energy');
          running := An_fba (it, after)
      | "mass", [ e; moved; force'; contact'; last; hip_force; left; mass; mass_moved; offset; at_mass ], An_enhanced (it, m) ->
          let after = enhanced_tick it m e moved in
          let phase = if contact' = zero then Free else if contact' = one then First else Augmenting in
          check line
            (after = { phase; last; hip_force; left; mass; mass_moved; offset; at_mass } && after.hip_force = force');
          reached after m;
          running := An_enhanced (it, after)
      | _ -> fail line "not what is written here")

let () =
  (try while true do take (input_line stdin) done with End_of_file -> ());
  if !ticks = 0 then fail "nothing" "nothing was compared";
  Array.iter (fun count -> if count < 50 then fail "the enhanced law" "a case was hardly reached") seen;
  if !ended < 1_000 then fail "the guard" "its force hardly ever ended";
  if !allowed < 10_000 || !refused < 10_000 then fail "settings" "hardly any were accepted, or hardly any refused";
  if !roots < 10_000 then fail "roots" "hardly any were compared";
  Printf.printf
    "%d ticks of %d guards and laws, and %d ends of a guard's force, are the extracted specification's, bit for bit, and so are what %d settings make and the refusal \
     of %d, and %d roots\n"
    !ticks !made !ended !allowed !refused !roots
