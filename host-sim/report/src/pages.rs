//! Writes a folder with a page of sections, `results.json` and further files, for commands whose results are not a list of runs.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::staging::{Staging, io_error};
use super::svg::escape;
use super::{ProgramVersion, Section, Written, html, previous};
use touchstone_sim::error::Result;

/// Contents of a results folder with a page.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    /// Heading of the page.
    pub title: &'a str,
    /// A description of the results in one or two sentences.
    pub intro: &'a str,
    /// Command line that repeats the results.
    pub command: &'a str,
    /// Version of the program.
    pub program: ProgramVersion,
    /// Sections of the page, from top to bottom.
    pub sections: &'a [Section],
    /// Name and value of the results' entry in `results.json`.
    pub results: (&'a str, &'a Value),
    /// Further files in the folder: their names and texts.
    pub files: &'a [(String, String)],
    /// Whether files of another command in the folder are replaced.
    pub force: bool,
}

/// HTML text of the page.
fn html(input: &Page) -> String {
    let mut page = String::new();
    let title = escape(input.title);
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{title}</title>\n<style>\n{}</style>\n</head>\n<body>\n\
         <header>\n<h1>{title}</h1>\n<p>{}</p>\n</header>\n<main>\n",
        crate::PAGE_STYLE,
        escape(input.intro)
    );
    input
        .sections
        .iter()
        .for_each(|section| html::write_section(&mut page, section, section.folded));
    page.push_str("</main>\n<footer>\n");
    html::again(&mut page, input.command);
    html::signature(&mut page, &input.program);
    page.push_str("</body>\n</html>\n");
    page
}

/// Writes the folder. On an error no new file is left; if moving the files failed half-way, some older ones are already replaced.
///
/// # Errors
/// The folder holds the results of another command, or cannot be written.
pub fn write(page: &Page, folder: &Path) -> Result<Written> {
    let mut names: Vec<String> = page.files.iter().map(|(name, _)| name.clone()).collect();
    names.extend(["results.json", "index.html"].map(str::to_owned));
    let stale = previous::stale(folder, page.command, page.force, &names)?;
    let (key, results) = page.results;
    let results = json!({
        "command": page.command,
        "version": page.program.version,
        "commit": page.program.commit,
        "modified": page.program.modified,
        "files": names,
        key: results,
    });
    let html = html(page);
    let mut texts: Vec<(&str, String)> = page
        .files
        .iter()
        .map(|(name, text)| (name.as_str(), text.clone()))
        .collect();
    texts.push(("results.json", format!("{results:#}\n")));
    texts.push(("index.html", html));
    let staging = Staging::new(folder).map_err(|error| io_error(folder, &error))?;
    let files: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
    let written = texts
        .iter()
        .try_for_each(|(name, text)| fs::write(staging.path.join(name), text))
        .and_then(|()| staging.publish(&files, &stale));
    written.map_err(|error| io_error(folder, &error))?;
    Ok(Written {
        page: folder.join("index.html"),
        files,
        bytes: texts.iter().map(|(_, text)| text.len() as u64).sum(),
    })
}
