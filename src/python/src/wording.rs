//! Words of Python for what the messages of the library hold as data: a setting is a keyword argument, an operation a function. What
//! only the tool has is named as the tool names it.

use crease::internal::bake::Observer;
use crease::internal::job::JobObserver;
use crease_cli::ToolWords;
use crease_model::error::{Operation, Setting, SettingValue, Vocabulary};

/// Words of Python.
#[derive(Debug, Clone, Copy)]
pub struct PythonWords;

impl Vocabulary for PythonWords {
    fn setting(&self, setting: Setting, value: Option<&SettingValue>) -> String {
        let Some(keyword) = keyword(setting) else { return ToolWords.setting(setting, value) };
        match value {
            None => keyword.to_owned(),
            Some(SettingValue::Number(number)) => format!("{keyword}={number}"),
            Some(SettingValue::Word(text) | SettingValue::Name(text)) => format!("{keyword}={text:?}"),
        }
    }

    fn operation(&self, operation: Operation) -> String {
        let function = match operation {
            Operation::Bake => "bake",
            Operation::Transfer => "transfer",
            Operation::ListFabrics => "fabrics",
            Operation::Remember | Operation::Inspect => return ToolWords.operation(operation),
        };
        format!("crease.{function}")
    }
}

/// Observer of jobs that report nothing but words.
impl Observer for PythonWords {}

impl JobObserver for PythonWords {
    fn words(&self) -> &'static dyn Vocabulary {
        &PythonWords
    }
}

/// Returns the keyword argument of a setting, if a function of the module has it.
fn keyword(setting: Setting) -> Option<&'static str> {
    match setting {
        Setting::Align => Some("align"),
        Setting::AllowFolder => Some("allow_folder"),
        Setting::Apply => Some("apply"),
        Setting::Fabric => Some("fabric"),
        Setting::ForceSize => Some("force_size"),
        Setting::Garment => Some("part"),
        Setting::Mask => Some("mask"),
        Setting::Match => Some("match_by"),
        Setting::Only => Some("only"),
        Setting::SewingMask => Some("sewing_mask"),
        Setting::Strength => Some("strength"),
        Setting::Target => Some("to"),
        Setting::Unit => Some("unit"),
        Setting::Up => Some("up"),
        Setting::Weld => Some("weld_mm"),
        Setting::Body
        | Setting::BodyNode
        | Setting::BodyFrameRate
        | Setting::BodyUnit
        | Setting::BodyUp
        | Setting::BodyWithout
        | Setting::DetailMap
        | Setting::Explain
        | Setting::FrameRate
        | Setting::FramesOf
        | Setting::FramesUnit
        | Setting::FullCharts
        | Setting::Hold
        | Setting::Landmarks
        | Setting::Mesh
        | Setting::Repeat
        | Setting::Resolution
        | Setting::Resume => None,
    }
}
