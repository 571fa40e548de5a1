//! `cargo xtask site`: builds a static web site in `target/site`: book, live pages, a report and the documentation of the crates.

use std::path::{Component, Path, PathBuf};

use crate::outcome::Outcome;
use crate::shell;

const INDEX: &str = r#"<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Touchstone</title>
<style>:root{color-scheme:light dark}body{font:1.1rem/1.6 system-ui,sans-serif;max-width:40rem;margin:2rem auto;padding:0 1rem}li{margin:.6rem 0}</style>
</head><body><h1>Touchstone</h1><p>Hard virtual walls: simulate them, compare control laws, and see what holds.</p><ul>
<li><a href="live.html">A wall under the mouse</a></li>
<li><a href="live-three-axes.html">A wall of three axes under the mouse</a></li>
<li><a href="board.html">A board in the browser</a>, for Chromium and its kin</li>
<li><a href="report/index.html">A report</a> of the thesis' comparison</li>
<li><a href="docs/index.html">The book</a></li>
<li><a href="api/touchstone_control/index.html">The API</a></li>
</ul></body></html>
"#;

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask site".into());
    }
    made().unwrap_or_else(|outcome| outcome)
}

fn made() -> Result<Outcome, Outcome> {
    if shell::capture(shell::program("mdbook").arg("--version")).is_none() {
        return Err(Outcome::NotRun(
            "no mdbook, which makes the book: cargo install --locked mdbook --version 0.4.52"
                .into(),
        ));
    }
    let site = shell::target("site");
    if site.exists() {
        done(std::fs::remove_dir_all(&site), &site)?;
    }
    let book = site.join("docs");
    done(std::fs::create_dir_all(&book), &book)?;
    let mut mdbook = shell::program("mdbook");
    mdbook.args(["build", "docs", "--dest-dir"]).arg(&book);
    shell::run(&mut mdbook).went_well()?;

    shell::run(shell::cargo_locked("build").args(["--release", "--bin", "touchstone"]))
        .went_well()?;
    let program = shell::target("release").join("touchstone");
    let calls: [(&[&str], &str); 4] = [
        (&["live", "--no-open"], "live.html"),
        (
            &["live", "--no-open", "--dof", "3", "plane"],
            "live-three-axes.html",
        ),
        (&["live", "--no-open", "--serial"], "board.html"),
        (&["thesis"], "report"),
    ];
    for (words, out) in calls {
        let mut call = shell::program(&program);
        shell::run(call.args(words).arg("--out").arg(site.join(out))).went_well()?;
    }
    let mut doc = shell::cargo_locked("doc");
    shell::run(doc.args(["--workspace", "--no-deps"])).went_well()?;
    copy(&shell::target("doc"), &site.join("api"))?;
    let index = site.join("index.html");
    done(std::fs::write(&index, INDEX), &index)?;
    // This file tells a host such as GitHub Pages to keep files whose names begin with an underscore.
    let plain = site.join(".nojekyll");
    done(std::fs::write(&plain, ""), &plain)?;

    let (pages, mut wrong) = checked(&site)?;
    wrong.sort();
    wrong.dedup();
    if let Some(first) = wrong.first() {
        for line in &wrong {
            println!("{line}");
        }
        return Err(Outcome::Failed(format!(
            "{} faults, the first: {first}",
            wrong.len()
        )));
    }
    Ok(Outcome::Ok(format!(
        "{}, {pages} pages, links good, nothing loaded from elsewhere",
        site.display()
    )))
}

/// Checks that no page of the built site loads anything from other hosts, and that links within the site have targets. Returns the
/// number of pages and the problems. Links of the crates' documentation are checked by `cargo xtask doc`.
fn checked(site: &Path) -> Result<(usize, Vec<String>), Outcome> {
    let mut wrong = Vec::new();
    let pages = pages(site)?;
    for page in &pages {
        let text = done(std::fs::read_to_string(page), page)?;
        let name = page
            .strip_prefix(site)
            .unwrap_or(page)
            .display()
            .to_string();
        for tag in loads_from_elsewhere(&text) {
            wrong.push(format!("{name}: loads from elsewhere: {tag}"));
        }
        if page.starts_with(site.join("api")) {
            continue;
        }
        for (link, place) in links(&text) {
            let to = if link.is_empty() {
                page.clone()
            } else {
                resolved(page.parent().unwrap_or(site), link)
            };
            if !to.starts_with(site) {
                wrong.push(format!("{name}: leaves the site: {link}"));
            } else if !to.exists() && !bring(site, &to)? {
                wrong.push(format!("{name}: leads nowhere: {link}"));
            } else if to.extension().is_some_and(|ending| ending == "html") && !place.is_empty() {
                let target = done(std::fs::read_to_string(&to), &to)?;
                if !target.contains(&format!("id=\"{place}\"")) {
                    wrong.push(format!(
                        "{name}: no such place on that page: {link}#{place}"
                    ));
                }
            }
        }
    }
    Ok((pages.len(), wrong))
}

/// Copies a file or folder of the repository to the path `to` in the site, because a page links to it. Returns whether the
/// repository has it.
fn bring(site: &Path, to: &Path) -> Result<bool, Outcome> {
    let inside = to.strip_prefix(site).unwrap_or(to);
    let source = shell::root().join(inside);
    let text = source.with_extension("md");
    if let Some(folder) = to.parent() {
        done(std::fs::create_dir_all(folder), folder)?;
    }
    if source.is_file() {
        done(std::fs::copy(&source, to), to)?;
    } else if text.is_file() && to.extension().is_some_and(|ending| ending == "html") {
        let text = done(std::fs::read_to_string(&text), &text)?;
        done(std::fs::write(to, plain_page(&text)), to)?;
    } else if source.is_dir() {
        copy(&source, to)?;
    } else {
        return Ok(false);
    }
    Ok(true)
}

/// A web page that shows a Markdown text unformatted, with headings that links can target.
fn plain_page(text: &str) -> String {
    let mut page =
        "<!doctype html><meta charset=\"utf-8\"><pre style=\"white-space:pre-wrap\">".to_owned();
    for line in text.replace('&', "&amp;").replace('<', "&lt;").lines() {
        match line.trim_start_matches('#').strip_prefix(' ') {
            Some(heading) if line.starts_with('#') => {
                page += &format!("<span id=\"{}\">{line}</span>\n", place_of(heading));
            }
            _ => page += &format!("{line}\n"),
        }
    }
    page + "</pre>"
}

/// The anchor of a heading, as code hosts and mdBook form it.
fn place_of(heading: &str) -> String {
    let words = heading.trim().to_lowercase().replace(' ', "-");
    let kept = |c: &char| c.is_alphanumeric() || ['-', '_'].contains(c);
    words.chars().filter(kept).collect()
}

fn resolved(folder: &Path, link: &str) -> PathBuf {
    let mut path = folder.to_path_buf();
    for part in Path::new(link).components() {
        match part {
            Component::ParentDir => {
                path.pop();
            }
            Component::Normal(name) => path.push(name),
            _ => {}
        }
    }
    path
}

/// Links in a page's `href` and `src` to targets within the site. Each is a pair: the page (empty for this page), and the anchor on
/// it (empty for its top). The part after `?` is left out, and so is a live page's list of settings after `#`.
fn links(html: &str) -> Vec<(&str, &str)> {
    let after = html
        .split(" href=\"")
        .skip(1)
        .chain(html.split(" src=\"").skip(1));
    after
        .filter_map(|rest| rest.split('"').next())
        .filter(|link| !link.contains(['$', '{', '+']))
        .map(|link| {
            let (to, place) = link.split_once('#').unwrap_or((link, ""));
            let place = if place.contains('=') { "" } else { place };
            (to.split('?').next().unwrap_or_default(), place)
        })
        .filter(|(to, _)| !to.contains(':'))
        .filter(|(to, place)| !to.is_empty() || !place.is_empty())
        .collect()
}

/// HTML tags that load a script, style, image, font or frame from another host.
fn loads_from_elsewhere(html: &str) -> Vec<&str> {
    let tags = html
        .split('<')
        .skip(1)
        .filter_map(|rest| rest.split('>').next());
    let is_load = |tag: &&str| {
        let name = tag.split(char::is_whitespace).next().unwrap_or_default();
        [
            "script", "link", "img", "iframe", "source", "video", "audio", "image",
        ]
        .contains(&name)
            && ["=\"http:", "=\"https:", "=\"//", "='http", "='//"]
                .iter()
                .any(|form| tag.contains(form))
    };
    let mut found: Vec<&str> = tags.filter(is_load).collect();
    // The book's script loads a list from the Rust playground's host for code that can be run there.
    if html.contains("class=\"playground\"") {
        found.push("class=\"playground\"");
    }
    found.extend(html.split("url(").skip(1).filter_map(|rest| {
        let inside = rest.split(')').next()?;
        let from = inside.trim_matches(['"', '\'']);
        (from.starts_with("http") || from.starts_with("//")).then_some(inside)
    }));
    found
}

fn pages(folder: &Path) -> Result<Vec<PathBuf>, Outcome> {
    let mut found = Vec::new();
    for entry in done(std::fs::read_dir(folder), folder)?.flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(pages(&path)?);
        } else if path
            .extension()
            .is_some_and(|ending| ending == "html" || ending == "css")
        {
            found.push(path);
        }
    }
    Ok(found)
}

fn copy(from: &Path, to: &Path) -> Result<(), Outcome> {
    done(std::fs::create_dir_all(to), to)?;
    for entry in done(std::fs::read_dir(from), from)?.flatten() {
        let (path, place) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy(&path, &place)?;
        } else {
            done(std::fs::copy(&path, &place), &place)?;
        }
    }
    Ok(())
}

fn done<T>(result: std::io::Result<T>, path: &Path) -> Result<T, Outcome> {
    result.map_err(|why| Outcome::Failed(format!("{}: {why}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_from_another_host_are_found_and_links_are_not_loads() {
        let loads = [
            "<script src=\"https://a/b.js\">",
            "<img alt='' src='//a/b.png'>",
            "<link href=\"http://a/b.css\">",
            "a { src: url(\"https://a/f.woff\") }",
            "<pre><pre class=\"playground\"><code>",
        ];
        for html in loads {
            assert_eq!(loads_from_elsewhere(html).len(), 1, "{html}");
        }
        let own = "<a href=\"https://a/\"><img src=\"b.png\"><style>a{b:url(c.png)}</style>";
        assert!(loads_from_elsewhere(own).is_empty());
    }

    #[test]
    fn headings_of_a_plain_page_are_targets() {
        let page = plain_page("# A & b\n#!/bin/sh\n## Index: claim, `equation`\n");
        assert!(page.contains("<span id=\"index-claim-equation\">## Index"));
        assert!(!page.contains("<span id=\"!") && page.contains("# A &amp; b"));
    }

    #[test]
    fn links_of_the_site_are_read_and_resolved() {
        let html =
            "<a href=\"../b.html#c\"><a href=\"https://a/\"><a href=\"#d\"><img src=\"e.png\">";
        let expected = [("../b.html", "c"), ("", "d"), ("e.png", "")];
        assert_eq!(links(html), expected);
        assert_eq!(
            links("<a href=\"live.html?a=1#set=b%3D1\">"),
            [("live.html", "")]
        );
        assert_eq!(
            resolved(Path::new("/site/docs"), "../b.html"),
            Path::new("/site/b.html")
        );
    }
}
