//! Values that are expressions.

use std::ops::Range;

use toml::de::DeValue;

use super::reader::Reader;
use super::table::Entry;
use crate::expression::{AngleUnit, ExpressionError, Formula, Scope};
use crate::file_problem::FileProblem;

impl Entry<'_, '_> {
    /// The value of an expression, where the file allows it; angles of functions are in degrees.
    pub(super) fn expression<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
    ) -> Option<f64> {
        let (DeValue::String(source), Some(scope)) =
            (self.value.get_ref(), reader.scope(self.span().start))
        else {
            self.type_error(reader, "a number");
            return None;
        };
        let formula = self.formula(reader, source, AngleUnit::Degree)?;
        let value = self.evaluate(reader, source, &formula, &scope)?;
        reader.set_evaluated(self.span().start, value);
        Some(value)
    }

    /// The expression in the text of a value.
    pub(crate) fn formula<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        source: &str,
        angle: AngleUnit,
    ) -> Option<Formula> {
        let report = |error: ExpressionError| {
            let span = self.part_span(reader, source, error.span.clone());
            reader.report(span, FileProblem::from(error.problem));
        };
        Formula::parse(source, angle).map_err(report).ok()
    }

    /// The value of an expression; a parameter without a value has its own error.
    pub(crate) fn evaluate<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        source: &str,
        formula: &Formula,
        scope: &Scope,
    ) -> Option<f64> {
        let report = |error: ExpressionError| {
            if !error.is_about(&scope.parameters) {
                let span = self.part_span(reader, source, error.span.clone());
                let names = scope.parameters.iter().map(String::as_str);
                reader.report_with(span, || FileProblem::from(error.among(names).problem).into());
            }
        };
        formula.evaluate(scope).map_err(report).ok()
    }

    /// The bytes of the document of a part of a text, which is a range of its bytes; the whole text, where it is written with escapes.
    pub fn part_span<P: From<FileProblem> + PartialEq>(
        &self,
        reader: &Reader<'_, P>,
        text: &str,
        part: Range<usize>,
    ) -> Range<usize> {
        let span = self.span();
        let quoted = reader.slice(span.clone());
        let is_plain = quoted.get(1..quoted.len().max(2) - 1) == Some(text);
        let start = span.start + 1;
        if is_plain { start + part.start..start + part.end } else { span }
    }
}
