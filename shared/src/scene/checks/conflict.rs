//! Conflicts between fields.

/// Values that are valid by themselves but not together.
pub(in crate::scene) struct Conflict {
    /// Paths of the fields that take part; the message is about the first.
    pub(in crate::scene) fields: Vec<String>,
    /// The first field's value and the allowed ones.
    pub(in crate::scene) message: String,
}

/// Conflicts found so far.
#[derive(Default)]
pub(in crate::scene) struct Conflicts(pub(in crate::scene) Vec<Conflict>);

impl Conflicts {
    /// Adds a conflict between `fields`; the message is about the first.
    pub(in crate::scene) fn note(&mut self, fields: &[impl AsRef<str>], message: String) {
        self.0.push(Conflict { fields: fields.iter().map(|field| field.as_ref().to_owned()).collect(), message });
    }
}
