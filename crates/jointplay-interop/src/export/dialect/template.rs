//! Text with names in braces.

use super::Problem;
use jointplay_format::place::nearest;

// Names that a template may contain, by kind of template.
pub(super) const ENDS: &[&str] = &["cell", "robot", "axes", "positions", "time"];
pub(super) const INSTRUCTION: &[&str] = &["number", "line", "text"];
pub(super) const STEP: &[&str] = &["number", "phase", "time", "duration", "positions", "effector"];
pub(super) const BLEND: &[&str] = &["overlap"];
pub(super) const POINT: &[&str] = &["number", "time", "positions", "velocities"];
pub(super) const WAFER: &[&str] = &["effector", "station", "slot"];
pub(super) const AXIS: &[&str] = &["name", "value", "number"];
pub(super) const COMMENT: &[&str] = &["text"];

/// Text with known names in braces.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Template {
    /// Text, and the name that follows it.
    parts: Vec<(String, &'static str)>,
    rest: String,
}

impl Template {
    pub(super) fn parse(text: &str, known: &'static [&'static str]) -> Result<Self, Problem> {
        let mut parts = Vec::new();
        let mut plain = String::new();
        let mut letters = text.chars().peekable();
        while let Some(letter) = letters.next() {
            match letter {
                '{' | '}' if letters.next_if_eq(&letter).is_some() => plain.push(letter),
                '{' => {
                    let mut name = String::new();
                    loop {
                        match letters.next() {
                            Some('}') => break,
                            Some(letter) => name.push(letter),
                            None => return Err(Problem::Open),
                        }
                    }
                    let Some(&name) = known.iter().find(|&&one| one == name) else {
                        let nearest = nearest(&name, known.iter().copied());
                        return Err(Problem::Name {
                            found: name,
                            nearest,
                            known: known.join(", "),
                        });
                    };
                    parts.push((std::mem::take(&mut plain), name));
                }
                '}' => return Err(Problem::Close),
                letter => plain.push(letter),
            }
        }
        Ok(Self { parts, rest: plain })
    }

    /// The text with the values of its names.
    pub(super) fn fill(&self, value: impl Fn(&str) -> String) -> String {
        let parts = self.parts.iter().map(|(text, name)| text.clone() + &value(name));
        parts.collect::<String>() + &self.rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_filled_in_and_braces_kept() {
        let template = Template::parse("{{{text}}} {text}!", COMMENT).unwrap();
        assert_eq!(template.fill(|name| name.to_uppercase()), "{TEXT} TEXT!");
    }
}
