// The page's settings as a scene of three axes, which `touchstone run` simulates.

/** The approach of a scene that is the same as a law with the thesis' settings. Scenes have no approach for the other laws. */
const APPROACHES = { spring: "spring", "spring-damper": "spring-damper", "enhanced-sfa": "magnitude" };
/** Largest stiffness of a scene, N/mm. */
const STIFFEST = 50;

/** What the user has to change before a scene can have the settings; an empty text if nothing. `facts` are those of the running loop. */
function notInScene(base, facts) {
  const k = facts.k_desired_n_per_m, own = Number(/^k_desired_n_per_m=(.*)$/m.exec(content.shipped)[1]);
  if (base === "shipped") {
    if (facts.per_axis) return "the shipped law is one law along the normal: clear One law for each axis";
    if (!facts.guard) return "the shipped law has its guard: tick Energy guard";
    return k === own ? "" : `the shipped law was tuned for ${own / 1e3} N/mm: set this stiffness, or choose another law`;
  }
  if (!APPROACHES[facts.law]) return `there is no law ${facts.law}: choose ${Object.keys(APPROACHES).join(", ")} or as shipped`;
  if (facts.per_axis && facts.law !== "enhanced-sfa") return "only the law enhanced-sfa can be one for each axis: clear One law for each axis";
  if (facts.guard) return "only the shipped law has a guard: clear Energy guard, or choose the law as shipped";
  return k > 0 && k <= 1e3 * STIFFEST ? "" : `the stiffness is above 0 and at most ${STIFFEST} N/mm: choose another`;
}

/** The settings as the text of a scene. `notInScene` must have found nothing. */
function sceneOf({ object, texture, material, base }, facts) {
  const approach = base === "shipped" ? "shipped" : facts.per_axis ? "per-axis" : APPROACHES[facts.law];
  const lines = ['name = "live-three-axes"', 'description = "Saved from the live page"', "dof = 3", "", "[object]", `kind = "${object}"`];
  if (texture) {
    const [height, period] = texture.split("/");
    lines.push("", "[object.texture]", `height_mm = ${height}`, `period_mm = ${period}`);
  }
  lines.push("", "[law]", `approach = "${approach}"`, `k_desired_n_per_mm = ${facts.k_desired_n_per_m / 1e3}`);
  const impact = base === "shipped" && content.materials.find(([name]) => name === material)?.[2];
  if (impact) lines.push("", "[law.impact]", impact.trimEnd());
  return `${lines.join("\n")}\n`;
}
