//! The deployed package's own files.

use crate::derived::Derived;
use crate::sources::{package, version};
use crate::wiring::Readme;
use crate::{Error, Files, Request, Target};
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

/// Buses of the emulated board.
const EMULATED_BUSES: usize = 1;

/// Where a deployed file's template is in this crate: path, template.
type Template = (&'static str, &'static str);

const LINUX: [Template; 2] = [
    ("Cargo.toml", include_str!("../templates/linux/Cargo.toml.tera")),
    ("README.md", include_str!("../templates/linux/README.md.tera")),
];

const CORTEX_M: [Template; 2] = [
    ("Cargo.toml", include_str!("../templates/cortex_m/Cargo.toml.tera")),
    ("README.md", include_str!("../templates/cortex_m/README.md.tera")),
];

/// Parts of both pages.
const WIRING: &str = include_str!("../templates/wiring.md.tera");

/// Adds everything but runtime crates and vectors.
pub(crate) fn add(
    derived: &Derived,
    request: &Request<'_>,
    files: &mut Files,
) -> Result<(), Error> {
    let description = &derived.drive;
    for (path, template) in match request.target {
        Target::Linux => LINUX,
        Target::CortexM => CORTEX_M,
    } {
        files.add(path, text(path, template, derived, request)?);
    }
    match request.target {
        Target::Linux => {
            files.add("src/main.rs", include_str!("../templates/linux/main.rs"));
        }
        Target::CortexM => {
            for (path, content) in [
                ("src/main.rs", include_str!("../templates/cortex_m/main.rs")),
                ("src/board.rs", include_str!("../templates/cortex_m/board.rs")),
                ("build.rs", include_str!("../templates/cortex_m/build.rs")),
                ("memory.x", include_str!("../templates/cortex_m/memory.x")),
            ] {
                files.add(path, content);
            }
        }
    }
    files.add("src/lib.rs", library(derived, request.plan.is_some()));
    files.add("src/dynamics.rs", derived.module.text.as_str());
    files.add("src/drive.rs", description.rust());
    files.add("tests/recorded.rs", include_str!("../templates/recorded.rs"));
    files.add("LICENSE-MIT", include_str!("../LICENSE-MIT"));
    files.add("LICENSE-APACHE", include_str!("../LICENSE-APACHE"));
    files.add("can/load.txt", description.report());
    files.add("can/setup.txt", description.setup_text());
    for (index, bus) in description.buses.iter().enumerate() {
        if let Some(dbc) = description.dbc(index) {
            files.add(format!("can/{}.dbc", bus.name), dbc);
        }
    }
    Ok(())
}

fn text(
    path: &str,
    template: &str,
    derived: &Derived,
    request: &Request<'_>,
) -> Result<String, Error> {
    let wrong = |error: tera::Error| {
        let message = format!("{error:?}");
        Error::Template { path: path.to_owned(), message }
    };
    let mut context = tera::Context::from_serialize(&Readme::new(derived)).map_err(wrong)?;
    context.insert("package", &package(derived));
    context.insert("target", &request.target.to_string());
    context.insert("cortex_m_rt", version("cortex-m-rt").unwrap_or_default());
    context.insert("emulated", &(derived.drive.buses.len() <= EMULATED_BUSES));
    let wiring = tera::Tera::one_off(WIRING, &context, false).map_err(wrong)?;
    context.insert("wiring", &wiring);
    tera::Tera::one_off(template, &context, false).map_err(wrong)
}

/// `src/lib.rs`.
fn library(derived: &Derived, has_plan: bool) -> String {
    let tokens = library_tokens(derived, has_plan);
    // What we emit parses; if not, the compiler of the output says so at the place.
    match syn::parse2::<syn::File>(tokens.clone()) {
        Ok(file) => prettyplease::unparse(&file),
        Err(_) => tokens.to_string(),
    }
}

fn library_tokens(derived: &Derived, has_plan: bool) -> TokenStream {
    let names = &derived.module.names;
    let (module, baked) = (format_ident!("{}", names.module), format_ident!("{}", names.baked));
    let drive = format_ident!("{}", derived.drive.name);
    let [n, nx, ns] = derived.module.dimensions;
    let [n, nx, ns] = [n, nx, ns].map(proc_macro2::Literal::usize_unsuffixed);
    let docs = [
        format!(" The robot `{}` on the drive `{}`.", derived.stem, derived.drive.name),
        String::new(),
        " The parameters of the model are folded into [`Robot`]; the type of the same module with \
         parameters at run time is there for identification."
            .to_owned(),
    ];
    let plan = match has_plan {
        true => quote!(Some(include_bytes!("plan.bin"))),
        false => quote!(None),
    };
    quote! {
        #(#![doc = #docs])*
        #![no_std]
        #![forbid(unsafe_code)]

        pub mod drive;
        pub mod dynamics;

        pub use drive::#drive::DRIVE;
        pub use dynamics::#module::{#baked as Robot, CONTROL, DESCRIPTION};

        /// Number of coordinates, q = [q_x, q_s].
        pub const N: usize = #n;
        /// Number of position variables q_x.
        pub const NX: usize = #nx;
        /// Number of shape variables q_s.
        pub const NS: usize = #ns;

        /// The robot.
        pub static ROBOT: Robot = Robot;

        /// The plan that the program has from the start.
        pub static PLAN: Option<&[u8]> = #plan;
    }
}
