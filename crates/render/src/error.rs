//! Why a description has no world.

use straal_scene::span::Span;

/// Why a description has no world. Validation finds nearly all of this earlier, with better words.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct CompileError {
    /// What is wrong.
    pub message: String,
    /// Where the description says it, as far as that is known.
    pub span: Span,
}

impl CompileError {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), span: Span::NONE }
    }

    pub(crate) fn at(message: impl Into<String>, span: Span) -> Self {
        Self { message: message.into(), span }
    }
}
