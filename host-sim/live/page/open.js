// Opens a CSV file (trace of a simulation or record of a board) and draws its data beside the run on the page, at the file's own times. If the file has the hand's rest points, they also move the hand of the run.
let openedFile = null;

/** Reads a CSV file with a header: a simulation's trace, a record of this page, or a file of `touchstone monitor`. */
function readCsv(text, surface) {
  const [head, ...lines] = text.trim().split(/\r?\n/), names = head.split(",");
  const column = (name) => { const at = names.indexOf(name); return at < 0 ? null : Float64Array.from(lines, (line) => { const cell = line.split(",")[at]; return cell === "" || cell === undefined ? NaN : Number(cell); }); };
  const time = column("time_s"), force = column("force_n_m"), deep = column("penetration_rad");
  const angle = column("angle_rad") ?? (deep && deep.map((e) => e + surface));
  if (!time || !force || !angle) throw new Error(`it needs time_s, force_n_m and angle_rad or penetration_rad; it has ${names.slice(0, 20).join(", ")}`);
  if (!time.length || [time, force, angle].some((numbers) => numbers.some((n) => !Number.isFinite(n))) || time.some((t, i) => i > 0 && t <= time[i - 1])) throw new Error("its numbers have gaps, or its time does not rise");
  const offset = column("offset_rad");
  const given = {
    time_s: time, angle_rad: angle, force_n_m: force, motor_force_n_m: column("motor_force_n_m") ?? force, hand_rad: column("hand_rad"), rest_rad: column("rest_rad"), velocity_rad_per_s: column("velocity_rad_per_s"),
    surface_shifted_rad: column("surface_shifted_rad") ?? (offset && offset.map((o) => surface - o)), mass_rad: column("mass_rad") ?? angle, energy_observed_j: column("energy_observed_j"), energy_true_j: column("energy_true_j"), energy_hand_j: column("energy_hand_j"),
  };
  return { given, length: time.length, rests: column("rest_rad") };
}

async function openFile(file) {
  try {
    const { given, length, rests } = readCsv(await file.text(), runs[0].facts.surface_rad);
    openedFile = { name: file.name, given, length, at: 0, clock: null, compared: 0, differing: 0, moves: Boolean(rests) };
    chosen.b = null;
    chosen.automatic = false;
    aim = null;
    run(false);
    open(false);
    // Sent after the run is opened and before its first tick, so that the file moves the hand from the first tick on.
    tell("play", { rests });
    run(true);
    $("record-told").textContent = `${file.name}: ${length} rows, drawn beside the run${rests ? "; its hand moves this run" : ""}.`;
  } catch (error) { complain(`${file.name}: ${error.message}`); }
  $("file").value = "";
}
function closeFile() {
  if (!openedFile) return;
  openedFile = null;
  runs = runs.filter((one) => !one.file);
  tell("play", { rests: null });
}

/** Makes the second run on the page, which shows the file's data. */
function fileRun(side) {
  const length = Math.max(2000, Math.ceil(Math.min(side.facts.rate_hz, 4000) * WINDOW_S * 1.1));
  return { facts: side.facts, warnings: "", title: openedFile.name, ring: new Ring(COLUMNS, length), second: true, last: null, peak: 0, got: 0, file: true };
}

/** Adds the file's rows up to the present time to the file's run, and counts the ticks at which its force differs from that of the page's run. */
function follow(rows) {
  const beside = runs[1], n = COLUMNS.length, [clock, time, force] = ["clock", "time_s", "force_n_m"].map((name) => COLUMNS.indexOf(name));
  if (!beside?.file || !openedFile) return;
  const { given, length } = openedFile;
  for (let at = 0; at < rows.length; at += n) {
    openedFile.clock ??= rows[at + clock] - rows[at + time];
    const now = rows[at + time];
    while (openedFile.at < length && given.time_s[openedFile.at] <= now + 1e-9) {
      const i = openedFile.at;
      beside.ring.push(COLUMNS.map((name) => (name === "clock" ? openedFile.clock + given.time_s[i] : given[name]?.[i] ?? NaN)));
      if (given.time_s[i] === now) {
        openedFile.compared += 1;
        openedFile.differing += Number(given.force_n_m[i] !== rows[at + force]);
      }
      openedFile.at += 1;
    }
  }
  if (beside.ring.size) beside.last = Object.fromEntries(COLUMNS.map((name) => [name, beside.ring.at(name, 0)]));
  const { name, at, compared, differing, moves } = openedFile;
  if (moves) $("record-told").textContent = `${name}: ${at} of ${length} rows; ${compared} control periods compared, ${differing} of them with another force.`;
}
$("open").addEventListener("click", () => $("file").click());
$("file").addEventListener("change", () => { if ($("file").files.length) openFile($("file").files[0]); });
