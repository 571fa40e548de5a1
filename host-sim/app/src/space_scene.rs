//! `touchstone run` for a scene with three axes.

use super::check::Subject;
use super::expect::{self, Expectations};
use super::out::{self, json, note, say};
use super::report_options::{ReportOptions, program};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use touchstone_lab::space_report as page;
use touchstone_lab::thesis::space::scene::SpaceScene;
use touchstone_lab::thesis::space::{self, Record};
use touchstone_report as report;
use touchstone_sim::error::{Error, Result};

/// Name, description and TOML text of the three-axis scene that comes with the program.
pub const SHIPPED: (&str, &str, &str) = (
    "delta-ball",
    "three axes: a ball touched with a simulated delta device; pressed, held, slid along and released",
    include_str!("../../../scenes/delta-ball.toml"),
);

/// Reads a three-axis scene: a TOML file with the field `dof`, else the shipped scene of this name. Returns `None` for all other
/// names and files.
pub fn read(file: &str) -> Result<Option<SpaceScene>> {
    let path = Path::new(file);
    let read = touchstone_sim::input::text(path, touchstone_sim::input::MOST_OF_SCENE);
    let text = match read {
        Ok(text) => text,
        Err(_) if file == SHIPPED.0 => SHIPPED.2.to_owned(),
        Err(_) => return Ok(None),
    };
    let Ok(Some(dof)) = text
        .parse::<toml::Table>()
        .map(|mut table| table.remove("dof"))
    else {
        return Ok(None);
    };
    let fix = "docs/schema/space-scene.schema.json has every field";
    let wrong = |line: usize, field: &str, problem: String| Error::File {
        file: PathBuf::from(path),
        line,
        field: field.to_owned(),
        problem,
        fix: fix.to_owned(),
    };
    let line = |at: usize| 1 + text[..at.min(text.len())].matches('\n').count();
    if !dof.is_integer() {
        let problem = format!("must be 3, is {dof}");
        return Err(wrong(line(text.find("dof").unwrap_or(0)), "dof", problem));
    }
    let scene: SpaceScene = toml::from_str(&text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let problem = error.message().replace('\n', " ");
        wrong(line(at), "scene of three axes", problem)
    })?;
    scene.completed().map(Some).map_err(|(field, problem)| {
        let name = field.rsplit('.').next().unwrap_or(field);
        wrong(line(text.find(name).unwrap_or(0)), field, problem)
    })
}

/// Options of `touchstone run` for a three-axis scene, without the scene itself.
pub struct RunOfSpace<'a> {
    pub print: bool,
    pub out: Option<&'a Path>,
    pub report: &'a ReportOptions,
    /// Name of an option that the user gave and that a three-axis scene does not support; `None` if there is none.
    pub lost: Option<&'static str>,
    pub expectations: &'a Expectations,
}

/// Runs `touchstone run` for a three-axis scene.
pub fn main(scene: &SpaceScene, asked: &RunOfSpace) -> Result<ExitCode> {
    if let Some(option) = asked.lost.or(asked.expectations.first_of_one_axis()) {
        return Err(Error::Option {
            option: option.to_owned(),
            problem: "does not apply to a scene of three axes".to_owned(),
            fix: "leave it out, or change the scene's file".to_owned(),
        });
    }
    if asked.print {
        return out::result(
            || serde_json::json!(scene),
            || {
                let text = toml::to_string(scene).map_err(|error| {
                    Error::device("TOML", error.to_string(), "report this as a bug")
                })?;
                say!("{}", text.trim_end());
                Ok(())
            },
        )
        .map(|()| ExitCode::SUCCESS);
    }
    asked.expectations.validate(false)?;
    let command = super::command_line();
    let files = asked.report.files();
    if let Some(folder) = asked.out {
        report::check_folder(folder, &command, files.force)?;
        super::interrupt::clean_up()?;
        super::interrupt::sweep(folder);
    }
    let record = space::run(&scene.cell()).map_err(|why| Error::Option {
        option: "law".to_owned(),
        problem: why.to_string(),
        fix: "choose another stiffness".to_owned(),
    })?;
    let runs = [record];
    let input = page::Input {
        command: &command,
        program: program(),
        files,
        mechanism: scene.mechanism.kind,
        held_out: None,
        runs: &runs,
        claims: &[],
        cards: &[],
    };
    let written = asked
        .out
        .map(|folder| page::write(&input, folder))
        .transpose()?;
    let (verdict, why) = runs[0].judged();
    let subject = subject(scene, &runs[0]);
    let checked = asked.expectations.check(false, std::iter::once(subject));
    out::result(
        || expect::with_demands(page::results(&input), &checked),
        || {
            let cell = scene.cell();
            say!(
                "{}: {}, {}, {} N/mm, on {}",
                scene.name,
                cell.touched(),
                cell.approach.name(),
                cell.k_desired_n_per_mm,
                cell.mechanism.about()
            );
            say!("{:<38}{:>14}", "verdict", verdict.name());
            if let Some(why) = why {
                say!("not judged: {why}");
            }
            for (name, number) in page::numbers(&runs[0]) {
                match number.is_finite() {
                    true => say!("{name:<38}{number:>14.6}"),
                    false => say!("{name:<38}{:>14}", "none"),
                }
            }
            Ok(())
        },
    )?;
    if let Some(written) = written
        && !json()
    {
        note!("report  {}", written.page.display());
    }
    let code = checked.conclude()?;
    match runs[0].stopped {
        false => Ok(code),
        true => Err(Error::device(
            scene.mechanism.kind.about(),
            "left the positions that its arms can reach",
            "choose a softer wall, or another object",
        )),
    }
}

/// The values of the run that the demands are checked against.
fn subject(scene: &SpaceScene, run: &Record) -> Subject {
    let (cell, (verdict, why)) = (scene.cell(), run.judged());
    Subject {
        name: format!(
            "{}: {}, {}, {} N/mm, {}",
            scene.name,
            cell.object.name(),
            cell.approach.name(),
            cell.k_desired_n_per_mm,
            cell.mechanism.word()
        ),
        verdict: verdict.name(),
        not_judged: why.map(|why| why.to_string()),
        penetration_max: None,
        k_displayed: None,
        energy_out: run.energy.out_j(),
    }
}
