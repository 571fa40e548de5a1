//! `touchstone live`: writes an HTML page that simulates a scene, with the mouse as the hand; or serves a page that shows a real
//! board.

use super::SceneOptions;
use super::board_page;
use super::browser::open;
use super::out::{note, result, tell};
use super::report_options::program_name;
use super::shell;
use super::whole::{Named, is_of_same_command};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use touchstone_control::{Choice as _, LawKind};
use touchstone_device::{Address, guard_settings};
use touchstone_lab::thesis::space as three_axes;
use touchstone_lab::thesis::space::surface_feel::{MATERIALS, material, material_table};
use touchstone_lab::thesis::space::tuned_wall::TunedWall;
use touchstone_link::rows::COLUMNS;
use touchstone_live::board_page as board;
use touchstone_live::page::{self, Content};
use touchstone_live::space_loop::{SpaceChoice, SpaceObject};
use touchstone_live::space_page;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::output;
use touchstone_sim::scene::{MotionSpec, Scene};
use touchstone_world::plant::{OMEGA3, OMEGA3_AXIS};

/// Options of `touchstone live`.
#[derive(Debug, Clone, clap::Args)]
pub struct Options {
    /// Name of a shipped scene (see `touchstone scenes`) or path of a scene's TOML file.
    #[arg(default_value = "thesis-knob")]
    scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// HTML file to write; an existing file is replaced only if it is such a page.
    #[arg(
        long,
        value_name = "PAGE.html",
        default_value = "touchstone-live.html",
        default_value_if("serial", "true", "touchstone-board.html")
    )]
    out: PathBuf,
    /// Writes the page without opening it.
    #[arg(long)]
    no_open: bool,
    /// Shows a board instead: serial port (/dev/ttyACM0, COM3) or tcp:HOST:PORT. Serves a page only to this machine, until Ctrl-C.
    #[arg(long, value_name = "PORT", conflicts_with_all = ["scene", "out", "SceneOptions"])]
    port: Option<Address>,
    /// Writes a page that connects to a board itself, without this program. Needs a browser with WebSerial (Chromium and
    /// relatives).
    #[arg(long, conflicts_with_all = ["scene", "port", "SceneOptions"])]
    serial: bool,
    /// Degrees of freedom. 3: a wall in three axes on a simulated omega.3; give `plane`, `inclined` or `sphere` in place of a
    /// scene.
    #[arg(long, value_name = "N", value_parser = ["1", "3"], conflicts_with_all = ["port", "serial", "SceneOptions"])]
    dof: Option<String>,
}

/// Runs `touchstone live`: writes the page and opens it, or serves it for a board.
pub fn main(options: &Options) -> Result<()> {
    if let Some(address) = &options.port {
        return board_page::main(address, !options.no_open);
    }
    if options.dof.as_deref() == Some("3") {
        return finish((&options.out, options.no_open), &space(&options.scene)?);
    }
    if options.serial {
        let (page, _) = board::render(&board::Content {
            way: board::Way::Serial,
            columns: &COLUMNS,
            place: "serial port",
            program: &program_name(),
        });
        return finish((&options.out, options.no_open), &page);
    }
    let page = knob(&options.scene, &options.changes, "live")?;
    finish((&options.out, options.no_open), &page)
}

/// Options of `touchstone feels edit`.
#[derive(Debug, Clone, clap::Args)]
pub struct EditOptions {
    /// Name of a feel (see `touchstone feels`) or path of a scene's TOML file.
    #[arg(value_name = "NAME")]
    pub scene: String,
    #[command(flatten)]
    changes: SceneOptions,
    /// HTML file to write; an existing file is replaced only if it is such a page.
    #[arg(long, value_name = "PAGE.html", default_value = "touchstone-feel.html")]
    out: PathBuf,
    /// Writes the page without opening it.
    #[arg(long)]
    no_open: bool,
}

/// Runs `touchstone feels edit`: writes the page of `touchstone live` for a feel, with the editor open.
pub fn edit(options: &EditOptions) -> Result<()> {
    let page = knob(&options.scene, &options.changes, "edit")?;
    finish((&options.out, options.no_open), &page)
}

/// Text of the page of a simulated knob. `word` is the command's word after which its options begin; `edit` opens the editor.
fn knob(name: &str, changes: &SceneOptions, word: &str) -> Result<String> {
    let (scene, _) = changes.load(name)?;
    let scene = without_files(scene)?;
    let words = std::env::args_os().skip(1);
    let words = words.map(|word| word.to_string_lossy().into_owned());
    Ok(page::render(&Content {
        scene: &scene.to_toml(),
        name: &scene.name,
        description: &scene.description,
        source: &source(name, words, word),
        program: &program_name(),
        edits: word == "edit",
    }))
}

/// Text of the page for three axes, with the objects of the thesis (§5.2). The page starts with the wall that `device run` plays on
/// an omega.3. The control laws of the thesis can be chosen, at five times the critical stiffness.
fn space(object: &str) -> Result<String> {
    let object = match object {
        // `thesis-knob` is the default value of the scene argument if the user gives none.
        "thesis-knob" | "sphere" => SpaceObject::Sphere(three_axes::RADIUS_MM),
        "plane" => SpaceObject::Plane(three_axes::Object::Horizontal.normal()),
        "inclined" => SpaceObject::Plane(three_axes::Object::Inclined.normal()),
        other => {
            return Err(Error::Option {
                option: "live --dof 3".to_owned(),
                problem: format!("there is no object `{other}`"),
                fix: "give plane, inclined or sphere".to_owned(),
            });
        }
    };
    let of = |law| SpaceChoice {
        object,
        texture: None,
        guard: Some(guard_settings(
            OMEGA3_AXIS.damping,
            0.0,
            three_axes::RATE_HZ,
        )),
        law,
        per_axis: false,
    };
    let rate_hz = three_axes::RATE_HZ;
    let mechanism = three_axes::Mechanism::Cartesian;
    let tuned = TunedWall::of(mechanism, rate_hz);
    let shipped = of(tuned.settings(rate_hz, OMEGA3.force_n));
    let laws = LawKind::WORDS
        .iter()
        .filter_map(|word| LawKind::of_word(word));
    let thesis: Vec<_> = laws
        .map(|law| of(three_axes::settings(law, 25.0)))
        .collect();
    let mut materials = Vec::new();
    for (name, values) in MATERIALS {
        let table = toml::to_string(&material_table(values, mechanism));
        materials.push(space_page::Material {
            name,
            impact: material(values, mechanism),
            scene: table.map_err(|error| {
                Error::device("TOML", error.to_string(), "report this as a bug")
            })?,
        });
    }
    Ok(space_page::render(
        &shipped,
        &thesis,
        &materials,
        &program_name(),
    ))
}

/// Writes the page, prints its path and opens the page in a browser.
fn finish((out, no_open): (&Path, bool), page: &str) -> Result<()> {
    write(out, page)?;
    let path = std::path::absolute(out).unwrap_or_else(|_| out.to_owned());
    result(
        || serde_json::json!({ "page": path, "bytes": page.len() }),
        || {
            tell!("page    {} ({} kB)", path.display(), page.len() / 1000);
            Ok(())
        },
    )?;
    if !no_open && !open(path.as_os_str()) {
        note!("note: no browser was found; open {} in one", path.display());
    }
    Ok(())
}

/// Text of the page without a scene, for reports. The writer of a report inserts the scene.
pub fn page_without_scene() -> String {
    page::render(&Content {
        scene: "",
        name: "",
        description: "",
        source: "",
        program: &program_name(),
        edits: false,
    })
}

/// The words of this program's command line, reduced to the scene's name and the options that change the scene, and quoted for a
/// shell. Options that concern only the page, such as `--out`, are left out. The options begin after the word `first`.
fn source(scene: &str, words: impl IntoIterator<Item = String>, first: &str) -> String {
    let mut words = words.into_iter().skip_while(|word| word != first);
    words.next();
    let mut kept = vec![shell::word(scene)];
    while let Some(word) = words.next() {
        match &*word {
            "--out" => drop(words.next()),
            "--no-open" | "--json" | "--quiet" | "-q" => {}
            word if word == scene || word.starts_with("--out=") => {}
            word => kept.push(shell::word(word)),
        }
    }
    kept.join(" ")
}

/// Replaces a recorded hand motion in the scene, because the page cannot read files: the mouse moves the hand instead.
fn without_files(scene: Scene) -> Result<Scene> {
    if !matches!(scene.operator.motion, MotionSpec::Recorded(_)) {
        return Ok(scene);
    }
    note!("note: the page has no recording; its hand is the mouse");
    scene.with(|scene| scene.operator.motion = MotionSpec::None)
}

fn write(path: &Path, page: &str) -> Result<()> {
    let place = Named {
        path,
        option: "--out",
        replaces: is_of_same_command(path, page::MARK),
    };
    let is_other = matches!(output::is_free(path), Err(error) if error.kind() == ErrorKind::AlreadyExists)
        && !place.replaces;
    if is_other {
        return Err(Error::Io {
            path: path.to_owned(),
            problem: "exists, and is not a page of `touchstone live`".to_owned(),
            fix: "give another file with --out, or remove it".to_owned(),
        });
    }
    place.write(page)
}

#[cfg(test)]
mod tests {
    use super::source;

    #[test]
    fn the_command_of_a_page_is_quoted_word_by_word() {
        for (scene, words, shown) in [
            (
                "thesis-knob",
                &["-q", "live", "--k-desired", "20", "--no-open"][..],
                "thesis-knob --k-desired 20",
            ),
            (
                "my scene.toml",
                &[
                    "live",
                    "--out",
                    "a b.html",
                    "my scene.toml",
                    "--set",
                    "name=a  b",
                ],
                "'my scene.toml' --set 'name=a  b'",
            ),
        ] {
            let words = words.iter().map(|word| (*word).to_owned());
            assert_eq!(source(scene, words, "live"), shown);
        }
    }
}
