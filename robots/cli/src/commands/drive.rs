//! `shapebot drive`: a drive description checked, and what is generated from it.

use crate::args::DriveArgs;
use crate::drive::{self, Drive};
use crate::failure::Outcome;
use crate::output::{self, Align, Columns};
use shapebot_drives::DRIVES;
use std::io::Write;
use std::path::Path;

pub(crate) fn run(args: &DriveArgs) -> Outcome {
    let mut stdout = anstream::stdout().lock();
    let Some(name) = &args.drive else { return list(&mut stdout) };
    let drive = drive::open(name, args.robot.as_deref())?;
    write!(stdout, "{}", drive.description.report())?;
    if let Some(folder) = &args.output {
        write_all(&mut stdout, &drive, folder)?;
    }
    Ok(())
}

fn list(to: &mut impl Write) -> Outcome {
    let mut columns =
        Columns::new(&[("drive", Align::Left), ("robot", Align::Left), ("", Align::Left)]);
    for (name, _) in DRIVES {
        let description = drive::open(name, None)?.description;
        columns.push(vec![(*name).to_owned(), description.robot, description.title]);
    }
    Ok(columns.write(to)?)
}

fn write_all(to: &mut impl Write, drive: &Drive, folder: &Path) -> Outcome {
    let description = &drive.description;
    let name = &description.name;
    let mut files = vec![
        (format!("{name}.rs"), description.rust()),
        (format!("{name}.report.txt"), description.report()),
        (format!("{name}.setup.txt"), description.setup_text()),
    ];
    for (index, bus) in description.buses.iter().enumerate() {
        let dbc = description.dbc(index).unwrap_or_default();
        files.push((format!("{name}.{}.dbc", bus.name), dbc));
    }
    for (file, text) in files {
        let path = folder.join(file);
        output::write_file(&path, text)?;
        writeln!(to, "wrote {}", path.display())?;
    }
    Ok(())
}
