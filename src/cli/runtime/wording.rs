//! Words of the tool for what the messages of the library hold as data: a setting is an option, an operation a command.

use crease_model::error::{Operation, Setting, SettingValue, Vocabulary};

/// Words of the tool.
#[derive(Debug, Clone, Copy)]
pub struct ToolWords;

impl Vocabulary for ToolWords {
    fn setting(&self, setting: Setting, value: Option<&SettingValue>) -> String {
        let option = option(setting);
        match value {
            None => option.to_owned(),
            Some(SettingValue::Word(value) | SettingValue::Number(value)) => format!("{option} {value}"),
            Some(SettingValue::Name(name)) => format!("{option} \"{name}\""),
        }
    }

    fn operation(&self, operation: Operation) -> String {
        format!("crease {}", command(operation))
    }
}

/// Returns the option of a setting.
fn option(setting: Setting) -> &'static str {
    match setting {
        Setting::AllowFolder => "--allow-folder",
        Setting::Align => "--align",
        Setting::Apply => "--apply",
        Setting::Body => "--body",
        Setting::BodyNode => "--body-node",
        Setting::BodyFrameRate => "--body-fps",
        Setting::BodyUnit => "--body-unit",
        Setting::BodyUp => "--body-up",
        Setting::BodyWithout => "--body-without",
        Setting::DetailMap => "--detail-map",
        Setting::Explain => "--explain",
        Setting::Fabric => "--fabric",
        Setting::ForceSize => "--force-size",
        Setting::FrameRate => "--fps",
        Setting::FramesOf => "--frames-of",
        Setting::FramesUnit => "--frames-unit",
        Setting::FullCharts => "--full",
        Setting::Garment => "--garment",
        Setting::Hold => "--hold",
        Setting::Landmarks => "--landmarks",
        Setting::Mask => "--mask",
        Setting::Match => "--match",
        Setting::Mesh => "--mesh",
        Setting::Only => "--only",
        Setting::Repeat => "--repeat",
        Setting::Resolution => "--resolution",
        Setting::Resume => "--resume",
        Setting::SewingMask => "--sewing-mask",
        Setting::Strength => "--strength",
        Setting::Target => "--to",
        Setting::Unit => "--unit",
        Setting::Up => "--up",
        Setting::Weld => "--weld",
    }
}

/// Returns the command of an operation, without the name of the program.
fn command(operation: Operation) -> &'static str {
    match operation {
        Operation::Bake => "bake",
        Operation::Transfer => "transfer",
        Operation::Remember => "remember",
        Operation::Inspect => "inspect",
        Operation::ListFabrics => "fabric list",
    }
}
