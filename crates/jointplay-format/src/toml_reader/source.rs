//! Texts of a document: the file, copies of its tables, and texts that it includes.
//!
//! Positions in the file come first; those of copies and of included texts follow, in the order of their creation.
//! An error in a copy has the place of the original, and an error in an included text that of its inclusion.

use std::ops::Range;
use std::rc::Rc;

use crate::expression::Scope;
use crate::place::Error;

/// The inclusion of a text.
pub struct Inclusion<P> {
    /// Name of the text, for messages.
    pub name: String,
    /// Where the document includes it (bytes).
    pub span: Range<usize>,
    /// The problem of the document that the included text of this name has an error.
    pub problem: fn(String, Error<P>) -> P,
}

/// One of the texts.
struct Source<P> {
    /// Position of its first byte in the document.
    base: usize,
    length: usize,
    /// The text of an included source; `None` for the file and its copies.
    text: Option<Rc<str>>,
    origin: Origin<P>,
    /// Values of the names in its expressions; `None` where expressions are not allowed.
    scope: Option<Rc<Scope>>,
}

enum Origin<P> {
    File,
    /// A copy of the source with this base.
    Copy(usize),
    Included(Inclusion<P>),
}

/// All texts of a document, in the order of their positions; the file is the first.
pub(super) struct Sources<P>(Vec<Source<P>>);

impl<P> Sources<P> {
    /// # Arguments
    /// * `length` – length of the file (bytes)
    pub(super) fn new(length: usize) -> Self {
        Self(vec![Source { base: 0, length, text: None, origin: Origin::File, scope: None }])
    }

    fn index(&self, position: usize) -> usize {
        self.0.partition_point(|source| source.base <= position).saturating_sub(1)
    }

    fn source(&self, position: usize) -> &Source<P> {
        &self.0[self.index(position)]
    }

    /// The text of a span; empty where it leaves its source.
    pub(super) fn slice(&self, file: &str, span: Range<usize>) -> String {
        let source = self.source(span.start);
        let end = span.end.saturating_sub(source.base);
        let text = source.text.as_deref().unwrap_or(file);
        text.get(span.start - source.base..end).unwrap_or_default().to_owned()
    }

    pub(super) fn scope(&self, position: usize) -> Option<Rc<Scope>> {
        self.source(position).scope.clone()
    }

    pub(super) fn set_scope(&mut self, position: usize, scope: Scope) {
        let index = self.index(position);
        self.0[index].scope = Some(Rc::new(scope));
    }

    /// Position of the first byte of a further source.
    fn end(&self) -> usize {
        self.0.last().map_or(0, |last| last.base + last.length + 1)
    }

    /// Adds a copy of the source at a position; returns the offset from the original to the copy.
    pub(super) fn copy(&mut self, position: usize, scope: Scope) -> usize {
        let &Source { base: original, length, ref text, .. } = self.source(position);
        let (text, base) = (text.clone(), self.end());
        let origin = Origin::Copy(original);
        self.0.push(Source { base, length, text, origin, scope: Some(Rc::new(scope)) });
        base - original
    }

    /// Adds an included text; returns the position of its first byte.
    pub(super) fn include(&mut self, text: &str, inclusion: Inclusion<P>) -> usize {
        let (base, length, origin) = (self.end(), text.len(), Origin::Included(inclusion));
        self.0.push(Source { base, length, text: Some(text.into()), origin, scope: None });
        base
    }

    /// The place of a problem in the file, with the problem as the file has it.
    pub(super) fn in_file(&self, mut span: Range<usize>, mut problem: P) -> (Range<usize>, P) {
        loop {
            let source = self.source(span.start);
            let local = span.start - source.base..span.end.max(span.start) - source.base;
            match &source.origin {
                Origin::File => return (span, problem),
                Origin::Copy(base) => span = local.start + base..local.end + base,
                Origin::Included(inclusion) => {
                    let error = Error::at(source.text.as_deref().unwrap_or(""), local, problem);
                    problem = (inclusion.problem)(inclusion.name.clone(), error);
                    span = inclusion.span.clone();
                }
            }
        }
    }

    /// The span in the file of a span of the document: that of the original, or of the inclusion.
    pub(super) fn span_in_file(&self, mut span: Range<usize>) -> Range<usize> {
        loop {
            let source = self.source(span.start);
            match &source.origin {
                Origin::File => return span,
                Origin::Copy(base) => {
                    let by = source.base - base;
                    span = span.start - by..span.end - by;
                }
                Origin::Included(inclusion) => span = inclusion.span.clone(),
            }
        }
    }
}
