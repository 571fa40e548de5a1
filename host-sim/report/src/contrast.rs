//! Tests that the colours of `page.css` have enough contrast in the light and the dark theme.

/// Reads a colour from the style sheet. `variables` is the block of variables of the light or the dark theme.
fn colour(variables: &str, name: &str) -> [f64; 3] {
    let hex = variables
        .split(&format!("--{name}: #"))
        .nth(1)
        .unwrap_or_else(|| panic!("{name}"));
    [0, 2, 4].map(|i| f64::from(u8::from_str_radix(&hex[i..i + 2], 16).unwrap()) / 255.0)
}

/// Contrast of two colours as WCAG 2 defines it.
fn contrast(a: [f64; 3], b: [f64; 3]) -> f64 {
    let linear = |c: f64| {
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    };
    let luminance =
        |c: [f64; 3]| 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn text_and_lines_stand_out_in_light_and_dark() {
    let css = crate::PAGE_STYLE;
    let (light, dark) = css
        .split_once("@media (prefers-color-scheme: dark)")
        .unwrap();
    for (theme, variables) in [("light", light), ("dark", dark)] {
        let check = |front: &str, back: &str| {
            let found = contrast(colour(variables, front), colour(variables, back));
            assert!(found >= 4.5, "{theme}: {front} on {back} is {found:.2}");
        };
        for back in ["page", "panel", "wall"] {
            for front in ["text", "muted", "link", "blue", "orange", "green", "grey"] {
                check(front, back);
            }
        }
        for verdict in ["passive", "active", "cycle", "unstable"] {
            for front in [verdict, "text", "muted"] {
                check(front, &format!("{verdict}-tint"));
            }
        }
    }
}
