//! What is to be deployed.

use std::fmt;

/// A text with the name that messages give it.
#[derive(Clone, Copy, Debug)]
pub struct Text<'a> {
    /// A path or a file's name. Its stem names modules and files.
    pub name: &'a str,
    /// The text.
    pub text: &'a str,
}

impl Text<'_> {
    /// The file's name without folders and ending.
    pub(crate) fn stem(&self) -> &str {
        let file = self.name.rsplit(['/', '\\']).next().unwrap_or(self.name);
        file.rsplit_once('.').map_or(file, |(stem, _)| stem)
    }
}

/// Where the robot's program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A process on Linux, over SocketCAN or slcan.
    Linux,
    /// A microcontroller with a Cortex-M4F.
    CortexM,
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Linux => "linux",
            Self::CortexM => "cortex-m",
        })
    }
}

/// What is to be deployed.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The model.
    pub model: Text<'a>,
    /// The drive description.
    pub drive: Text<'a>,
    /// Where the program runs.
    pub target: Target,
    /// Binary plan file that the program has from the start; on a microcontroller its only one.
    pub plan: Option<&'a [u8]>,
}
