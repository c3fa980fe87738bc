//! Errors in words a user can act on: the file, the location in it, the problem, and how to fix it.
//!
//! A message that advises another setting holds the setting as data, so that a tool can word it as an option and a
//! binding as a keyword: [`Message`], [`Vocabulary`].

use serde::{Deserialize, Serialize};

/// Result of every fallible call of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// One problem of an input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Diagnostic {
    /// File (or other source) as the user named it.
    pub file: String,
    /// Location in the file: "line 12, column 4", "meshes[0].primitives[1]", ...; empty for the whole file.
    pub location: String,
    /// Description of the problem.
    pub message: Message,
    /// Advice on how to fix it; empty when there is none.
    pub help: Message,
    /// The line of a text file with a mark under the place, two lines; empty for other files. Not part of the text of the
    /// diagnostic: a tool may print it below.
    pub excerpt: String,
}

impl Diagnostic {
    /// Creates a diagnostic of `file` at `location`.
    pub fn new(
        file: impl Into<String>,
        location: impl Into<String>,
        message: impl Into<Message>,
        help: impl Into<Message>,
    ) -> Self {
        Self {
            file: file.into(),
            location: location.into(),
            message: message.into(),
            help: help.into(),
            excerpt: String::new(),
        }
    }

    /// Adds the excerpt of the text that it is about.
    pub fn with_excerpt(self, excerpt: String) -> Self {
        Self { excerpt, ..self }
    }

    /// Returns the whole diagnostic as one message.
    pub fn to_message(&self) -> Message {
        let location = if self.location.is_empty() { String::new() } else { format!(": {}", self.location) };
        let problem = Message::from(format!("{}{location}: ", self.file)) + self.message.clone();
        if self.help.is_empty() { problem } else { problem + " (" + self.help.clone() + ")" }
    }
}

impl std::fmt::Display for Diagnostic {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.to_message())
    }
}

/// Failures of the library's calls.
///
/// ```
/// use crease_model::error::Error;
/// use crease_model::fabric::Fabric;
/// match Fabric::preset("demin") {
///     Err(Error::Input(problems)) => assert!(problems[0].help.contains("denim")),
///     other => panic!("{other:?}"),
/// }
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Invalid input, with every problem found in it. Exit code 1.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Input(Vec<Diagnostic>),
    /// Divergence of the solver; the caller keeps the last accepted state. Exit code 3.
    #[error("did not converge: {0}")]
    NotConverged(Message),
    /// An action of the script that was carried out and did not do what it should: a flap that did not turn over, a garment that
    /// does not lie. Exit code 3.
    #[error("did not take place: {0}")]
    NotPerformed(Box<Diagnostic>),
    /// Result without any effect: nothing changed. Exit code 3.
    #[error("empty result: {0}")]
    Empty(Message),
    /// Stop on request; the caller may have kept a checkpoint.
    #[error("interrupted")]
    Interrupted,
    /// Failure to read or write a file. Exit code 1.
    #[error("{file}: {source}")]
    File {
        /// File as the user named it.
        file: String,
        /// Error reported by the operating system.
        source: std::io::Error,
    },
}

impl Error {
    /// Creates [`Error::Input`] with a single diagnostic.
    pub fn input(
        file: impl Into<String>,
        location: impl Into<String>,
        message: impl Into<Message>,
        help: impl Into<Message>,
    ) -> Self {
        Self::Input(vec![Diagnostic::new(file, location, message, help)])
    }

    /// Returns its text in the words of `words`; [`ToString`] has those of the library.
    pub fn worded(&self, words: &dyn Vocabulary) -> String {
        match self {
            Self::Input(all) => {
                all.iter().map(|one| one.to_message().worded(words)).collect::<Vec<_>>().join("\n")
            }
            Self::NotConverged(reason) => format!("did not converge: {}", reason.worded(words)),
            Self::NotPerformed(failure) => {
                format!("did not take place: {}", failure.to_message().worded(words))
            }
            Self::Empty(reason) => format!("empty result: {}", reason.worded(words)),
            Self::Interrupted | Self::File { .. } => self.to_string(),
        }
    }
}

/// Setting of a library call. Exhaustive, so that every [`Vocabulary`] has a word for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Setting {
    /// Folder from which a file may read others, besides its own.
    AllowFolder,
    /// Alignment of the source of a transfer with its target.
    Align,
    /// Worn shape as the base shape of a file.
    Apply,
    /// Body that the garment is worn on.
    Body,
    /// Part of a file that is the body.
    BodyNode,
    /// Frames per second of a body that is a sequence of files.
    BodyFrameRate,
    /// Unit of the body file.
    BodyUnit,
    /// Up axis of the body file.
    BodyUp,
    /// Joints or parts that are left out of the body.
    BodyWithout,
    /// Normal map of fine wrinkles.
    DetailMap,
    /// List of the models that a bake would use.
    Explain,
    /// Fabric of the garment.
    Fabric,
    /// Garments of any size.
    ForceSize,
    /// Frames per second of a sequence of files.
    FrameRate,
    /// Mesh that the frames of a bake show.
    FramesOf,
    /// Unit of the frames of a motion.
    FramesUnit,
    /// Scenes of a chart with a long run time.
    FullCharts,
    /// Parts of a file that are the garment.
    Garment,
    /// Points that stay where the skin of the file has them.
    Hold,
    /// Points marked on source and target of a transfer.
    Landmarks,
    /// Vertex attribute that scales the memory.
    Mask,
    /// Matching of points in a transfer.
    Match,
    /// Source pose of the garment in motion.
    Mesh,
    /// Part of the memory that is transferred.
    Only,
    /// Number of times that a motion is repeated.
    Repeat,
    /// Edge length of a refined garment [mm].
    Resolution,
    /// Continuation of a run from its checkpoint.
    Resume,
    /// Vertex attribute that scales hems and seams.
    SewingMask,
    /// Factor on the memory.
    Strength,
    /// Garment to which memory is transferred.
    Target,
    /// Unit of the garment file.
    Unit,
    /// Up axis of the garment file.
    Up,
    /// Distance within which borders are joined [mm].
    Weld,
}

/// Operation of the library. Exhaustive, so that every [`Vocabulary`] has a word for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Operation {
    /// Simulation of a script.
    Bake,
    /// Transfer of memory to another garment.
    Transfer,
    /// Memory from an existing motion.
    Remember,
    /// Report about a mesh file.
    Inspect,
    /// List of the fabrics.
    ListFabrics,
}

/// Value that is advised for a setting.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SettingValue {
    /// One of the words that the setting takes, or a file.
    Word(String),
    /// Name in a file, which may have spaces.
    Name(String),
    /// Number, in the unit of the setting.
    Number(String),
}

/// Part of a message that is data.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Term {
    /// A setting, with the value that is advised, if there is one.
    Setting(Setting, Option<SettingValue>),
    /// An operation.
    Operation(Operation),
}

/// Words of a front end for settings and operations.
pub trait Vocabulary {
    /// Returns the words for `setting`, with `value` if there is one.
    fn setting(&self, setting: Setting, value: Option<&SettingValue>) -> String;

    /// Returns the words for `operation`.
    fn operation(&self, operation: Operation) -> String;
}

/// Words of the library: paths of its items.
#[derive(Debug, Clone, Copy, Default)]
pub struct LibraryWords;

impl Vocabulary for LibraryWords {
    fn setting(&self, setting: Setting, value: Option<&SettingValue>) -> String {
        let path = setting.path();
        match (setting, value) {
            (_, None) => path.to_owned(),
            (Setting::Weld | Setting::Resolution, Some(SettingValue::Number(mm))) => {
                format!("{path} ({mm} mm)")
            }
            (_, Some(SettingValue::Word(value) | SettingValue::Number(value))) => format!("{path} ({value})"),
            (_, Some(SettingValue::Name(name))) => format!("{path} (\"{name}\")"),
        }
    }

    fn operation(&self, operation: Operation) -> String {
        operation.path().to_owned()
    }
}

impl Setting {
    /// All settings, in order.
    pub const ALL: [Self; 33] = [
        Self::AllowFolder,
        Self::Align,
        Self::Apply,
        Self::Body,
        Self::BodyNode,
        Self::BodyFrameRate,
        Self::BodyUnit,
        Self::BodyUp,
        Self::BodyWithout,
        Self::DetailMap,
        Self::Explain,
        Self::Fabric,
        Self::ForceSize,
        Self::FrameRate,
        Self::FramesOf,
        Self::FramesUnit,
        Self::FullCharts,
        Self::Garment,
        Self::Hold,
        Self::Landmarks,
        Self::Mask,
        Self::Match,
        Self::Mesh,
        Self::Only,
        Self::Repeat,
        Self::Resolution,
        Self::Resume,
        Self::SewingMask,
        Self::Strength,
        Self::Target,
        Self::Unit,
        Self::Up,
        Self::Weld,
    ];

    /// Returns the path of its item in the library.
    fn path(self) -> &'static str {
        match self {
            Self::AllowFolder => "ReadOptions::allow_folder",
            Self::Align => "Transfer::align",
            Self::Apply => "apply_worn",
            Self::Body => "Bake::body",
            Self::BodyNode => "AnimatedBody::from_pieces",
            Self::BodyFrameRate => "frames per second of the body",
            Self::BodyUnit => "ReadOptions::unit_m of the body",
            Self::BodyUp => "ReadOptions::up of the body",
            Self::BodyWithout => "AnimatedBody::leave_out",
            Self::DetailMap => "add_detail_map",
            Self::Explain => "Bake::plan",
            Self::Fabric => "Fabric::load",
            Self::ForceSize => "ReadOptions::any_size",
            Self::FrameRate => "AnimatedBody::from_frames",
            Self::FramesOf => "BakeOptions::frames_of_simulated",
            Self::FramesUnit => "ReadOptions::unit_m of the frames",
            Self::FullCharts => "ChartOptions::full",
            Self::Garment => "ReadOptions::garment",
            Self::Hold => "BakeOptions::skin",
            Self::Landmarks => "Transfer::landmarks",
            Self::Mask => "ReadOptions::mask",
            Self::Match => "Transfer::match_by",
            Self::Mesh => "memory_from_motion",
            Self::Only => "Transfer::channels",
            Self::Repeat => "GarmentMotion::repetitions",
            Self::Resolution => "Garment::refine",
            Self::Resume => "Bake::resume",
            Self::SewingMask => "ReadOptions::sewing_mask",
            Self::Strength => "Transfer::strength",
            Self::Target => "Transfer::new",
            Self::Unit => "ReadOptions::unit_m",
            Self::Up => "ReadOptions::up",
            Self::Weld => "ReadOptions::weld_m",
        }
    }

    /// Returns the setting with one of the words that it takes, or a file, as its value.
    pub fn to(self, word: impl Into<String>) -> Term {
        Term::Setting(self, Some(SettingValue::Word(word.into())))
    }

    /// Returns the setting with a name from a file as its value.
    pub fn to_name(self, name: impl Into<String>) -> Term {
        Term::Setting(self, Some(SettingValue::Name(name.into())))
    }

    /// Returns the setting with a number as its value, written as it is to be shown.
    pub fn to_number(self, number: impl Into<String>) -> Term {
        Term::Setting(self, Some(SettingValue::Number(number.into())))
    }
}

impl Operation {
    /// Returns the path of its item in the library.
    fn path(self) -> &'static str {
        match self {
            Self::Bake => "Bake",
            Self::Transfer => "Transfer",
            Self::Remember => "memory_from_motion",
            Self::Inspect => "inspect",
            Self::ListFabrics => "Fabric::preset_names",
        }
    }
}

impl Term {
    fn worded(&self, words: &dyn Vocabulary) -> String {
        match self {
            Self::Setting(setting, value) => words.setting(*setting, value.as_ref()),
            Self::Operation(operation) => words.operation(*operation),
        }
    }
}

/// Text for the user in which settings and operations are data. It reads as a `str` in the words of the library;
/// [`Message::worded`] has those of a front end.
///
/// ```
/// use crease_model::error::{Message, Operation, Setting};
/// let message = Message::from("say the unit with ") + Setting::Unit.to("cm") + ", or see " + Operation::Inspect;
/// assert_eq!(&*message, "say the unit with ReadOptions::unit_m (cm), or see inspect");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Message {
    /// The text in the words of the library.
    text: String,
    /// Settings and operations in it, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    terms: Vec<PlacedTerm>,
}

/// Term at its place in a text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PlacedTerm {
    /// First byte of its words.
    start: usize,
    /// Byte after them.
    end: usize,
    term: Term,
}

impl Message {
    /// Returns the text in the words of the library.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Returns the text in the words of `words`.
    pub fn worded(&self, words: &dyn Vocabulary) -> String {
        let (mut text, mut at) = (String::new(), 0);
        for PlacedTerm { start, end, term } in &self.terms {
            // A message that was read from a file may be anything.
            text += self.text.get(at..*start).unwrap_or_default();
            text += &term.worded(words);
            at = *end;
        }
        text + self.text.get(at..).unwrap_or_default()
    }

    /// Returns the message with `to` in place of the setting `from`.
    pub fn with_setting(self, from: Setting, to: Setting) -> Self {
        let (mut message, mut at) = (Self::default(), 0);
        for PlacedTerm { start, end, term } in self.terms {
            let term = match term {
                Term::Setting(own, value) if own == from => Term::Setting(to, value),
                other => other,
            };
            message = message + self.text.get(at..start).unwrap_or_default() + term;
            at = end;
        }
        message + self.text.get(at..).unwrap_or_default()
    }

    /// Whether it names `setting`.
    pub fn names_setting(&self, setting: Setting) -> bool {
        self.terms.iter().any(|placed| matches!(&placed.term, Term::Setting(own, _) if *own == setting))
    }

    /// Joins messages with `separator` between them.
    pub fn join(all: impl IntoIterator<Item = Self>, separator: &str) -> Self {
        all.into_iter().reduce(|joined, next| joined + separator + next).unwrap_or_default()
    }
}

impl<T: Into<Message>> std::ops::Add<T> for Message {
    type Output = Self;

    fn add(mut self, other: T) -> Self {
        let Self { text, terms } = other.into();
        let offset = self.text.len();
        self.terms.extend(terms.into_iter().map(|PlacedTerm { start, end, term }| PlacedTerm {
            start: start.saturating_add(offset),
            end: end.saturating_add(offset),
            term,
        }));
        self.text += &text;
        self
    }
}

impl std::ops::Deref for Message {
    type Target = str;

    fn deref(&self) -> &str {
        &self.text
    }
}

impl std::fmt::Display for Message {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(&self.text)
    }
}

impl From<String> for Message {
    fn from(text: String) -> Self {
        Self { text, terms: Vec::new() }
    }
}

impl From<&str> for Message {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<Term> for Message {
    fn from(term: Term) -> Self {
        let text = term.worded(&LibraryWords);
        let terms = vec![PlacedTerm { start: 0, end: text.len(), term }];
        Self { text, terms }
    }
}

impl From<Setting> for Message {
    fn from(setting: Setting) -> Self {
        Term::Setting(setting, None).into()
    }
}

impl From<Operation> for Message {
    fn from(operation: Operation) -> Self {
        Term::Operation(operation).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Shouted;

    impl Vocabulary for Shouted {
        fn setting(&self, setting: Setting, value: Option<&SettingValue>) -> String {
            format!("{setting:?}{}", if value.is_some() { "!" } else { "" })
        }

        fn operation(&self, operation: Operation) -> String {
            format!("{operation:?}")
        }
    }

    #[test]
    fn a_message_has_the_words_of_its_front_end() {
        let advice = Message::from("give ") + Setting::Mask.to("a") + " or " + Operation::Bake;
        let all = Message::from("é: ") + advice.clone() + format!(", {}", 2);
        assert_eq!(&*all, "é: give ReadOptions::mask (a) or Bake, 2");
        assert_eq!(all.worded(&Shouted), "é: give Mask! or Bake, 2");
        assert_eq!(all.worded(&LibraryWords), all.to_string());
        let other = all.clone().with_setting(Setting::Mask, Setting::Hold);
        assert_eq!(other.worded(&Shouted), "é: give Hold! or Bake, 2");
        let error = Error::input("file", "line 2", "is bad", advice);
        assert_eq!(error.worded(&Shouted), "file: line 2: is bad (give Mask! or Bake)");
        let data = serde_json::to_string(&all).expect("is plain data");
        assert_eq!(serde_json::from_str::<Message>(&data).expect("reads"), all);
    }

    #[test]
    fn a_message_with_terms_out_of_place_is_read_without_panic() {
        let terms = |start, end| vec![PlacedTerm { start, end, term: Term::Operation(Operation::Bake) }];
        for (start, end) in [(1, 2), (5, 3), (9, usize::MAX)] {
            let bad = Message { text: "é".to_owned(), terms: terms(start, end) };
            let _ = (bad.worded(&Shouted), bad.clone().with_setting(Setting::Mask, Setting::Hold));
            let _ = Message::from("a") + bad;
        }
    }
}
