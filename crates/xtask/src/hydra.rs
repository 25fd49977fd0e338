//! `cargo xtask hydra`: builds the delegate and lays it out as OpenUSD looks for plugins.
//!
//! ```text
//! target/hydra/plugin/usd/            PXR_PLUGINPATH_NAME
//!     plugInfo.json                   "look into every */resources/"
//!     hdUmber/hdUmber.so
//!     hdUmber/resources/plugInfo.json
//! target/hydra/blender/umber/         an add-on for Blender
//!     __init__.py ..., LICENSE-*
//!     plugin/                         as target/hydra/plugin/usd
//! ```

use std::{
    env,
    env::consts::{ARCH, OS},
    fs,
    path::{Path, PathBuf},
    process::{Command, ExitCode, Stdio},
};

use anyhow::{Context, Result, ensure};

use crate::{
    process,
    usd::{self, UsdBuild},
    workspace,
};

/// Runs the command.
///
/// # Errors
/// The delegate does not compile, or the plugin folder cannot be written.
pub fn run() -> Result<ExitCode> {
    let Some(usd) = UsdBuild::find()? else {
        eprintln!("{}", usd::MISSING);
        return Ok(ExitCode::FAILURE);
    };
    let plugins = build(&usd)?;
    println!("PXR_PLUGINPATH_NAME={}", plugins.display());
    println!("add-on for Blender: {}", lay_out_add_on(&plugins)?.display());
    Ok(ExitCode::SUCCESS)
}

/// Builds the plugin against `usd`; gives the folder for `PXR_PLUGINPATH_NAME`.
///
/// # Errors
/// As [`run`].
pub fn build(usd: &UsdBuild) -> Result<PathBuf> {
    let mut command = process::cargo();
    command.args(["build", "--quiet", "--release", "--package", "umber-hydra"]);
    command.arg("--message-format=json-render-diagnostics");
    let output = link_against(&mut command, usd)?.stderr(Stdio::inherit()).output().context("cargo build")?;
    ensure!(output.status.success(), "the delegate does not build against {}", usd.library_dir.display());
    let library = built_library(&String::from_utf8_lossy(&output.stdout))?;
    lay_out(&library)
}

/// Tells the build script of the delegate where OpenUSD is.
///
/// # Errors
/// A path cannot be joined with others.
pub fn link_against<'c>(command: &'c mut Command, usd: &UsdBuild) -> Result<&'c mut Command> {
    let include = env::join_paths(&usd.include)?;
    command.env("UMBER_USD_INCLUDE", include);
    command.env("UMBER_USD_LIBRARY_DIR", &usd.library_dir);
    Ok(command.env("UMBER_USD_LIBRARIES", usd.libraries.join(":")).current_dir(workspace::root()))
}

/// A command for the Python of `usd`, with its modules and the delegate in `plugins` to be found.
///
/// # Errors
/// A package that the hosts need cannot be had, or the library for reading buffers does not build.
pub fn host_command(usd: &UsdBuild, plugins: &Path) -> Result<Command> {
    let mut command = usd.venv()?.command();
    command
        .env("PYTHONPATH", &usd.python_path)
        .env("PXR_PLUGINPATH_NAME", plugins)
        .env("UMBER_PLUGIN_PATH", plugins)
        .env("UMBER_ENGINE_BUFFERS", engine_buffers(usd)?);
    if let Some(sdk) = usd.sdk.as_ref().filter(|_| env::var_os(MATERIALX_LIBRARY).is_none()) {
        command.env(MATERIALX_LIBRARY, sdk.materialx_library());
    }
    Ok(command)
}

/// Where OpenUSD looks for MaterialX's standard library; without it such materials come out empty.
const MATERIALX_LIBRARY: &str = "PXR_MTLX_STDLIB_SEARCH_PATHS";

/// The library through which the host drivers read buffers back, built where its source is newer.
fn engine_buffers(usd: &UsdBuild) -> Result<PathBuf> {
    let source = workspace::root().join("cpp_shim/testing/engine_buffers.cpp");
    let tools = workspace::target().join("hydra/tools");
    let library = tools.join(format!("engine_buffers.{}", env::consts::DLL_EXTENSION));
    let mut compiler = Command::new(env::var_os("CXX").unwrap_or_else(|| "c++".into()));
    // OpenUSD includes headers that the compiler holds deprecated: not ours to mend.
    compiler.args(["-std=c++17", "-O1", "-fPIC", "-shared", "-Wall", "-Wextra", "-Werror", "-Wno-deprecated"]);
    compiler.args(usd.include.iter().flat_map(|dir| ["-isystem".as_ref(), dir.as_os_str()]));
    compiler.arg(&source).arg("-L").arg(&usd.library_dir);
    compiler.args(usd.libraries.iter().map(|name| format!("-l{name}")));
    compiler.arg(format!("-Wl,-rpath,{}", usd.library_dir.display()));
    let content = fs::read_to_string(&source).with_context(|| source.display().to_string())?;
    let state = format!("{compiler:?}\n{content}");
    fs::create_dir_all(&tools).with_context(|| tools.display().to_string())?;
    workspace::once(&tools.join("engine_buffers.done"), &state, || {
        process::quiet(compiler.arg("-o").arg(&library)).map(drop)
    })?;
    Ok(library)
}

/// The shared library among what cargo says it built.
fn built_library(messages: &str) -> Result<PathBuf> {
    let messages = messages.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let artifact = messages
        .rev()
        .filter(|message| message["reason"] == "compiler-artifact")
        .find(|message| message["target"]["kind"].as_array().is_some_and(|kinds| kinds.contains(&"cdylib".into())))
        .context("the package umber-hydra builds no cdylib")?;
    let files = artifact["filenames"].as_array().into_iter().flatten().filter_map(serde_json::Value::as_str);
    let library = files.map(PathBuf::from).find(|file| file.extension() == Some(env::consts::DLL_EXTENSION.as_ref()));
    library.context("cargo names no shared library")
}

/// Puts the library and its manifests in place. A host that has the old library loaded keeps it.
fn lay_out(library: &Path) -> Result<PathBuf> {
    let plugins = workspace::target().join("hydra/plugin/usd");
    let resources = plugins.join("hdUmber/resources");
    fs::create_dir_all(&resources).with_context(|| resources.display().to_string())?;
    let name = format!("hdUmber.{}", env::consts::DLL_EXTENSION);
    let template = workspace::root().join("plugInfo/plugInfo.json.in");
    let manifest = fs::read_to_string(&template)
        .with_context(|| template.display().to_string())?
        .replace("@PLUG_INFO_LIBRARY_PATH@", &name)
        .replace("@PLUG_INFO_RESOURCE_PATH@", "resources")
        .replace("@PLUG_INFO_ROOT@", "..");
    replace(&plugins.join("hdUmber").join(name), &fs::read(library).with_context(|| library.display().to_string())?)?;
    replace(&resources.join("plugInfo.json"), manifest.as_bytes())?;
    replace(&plugins.join("plugInfo.json"), b"{\n    \"Includes\": [ \"*/resources/\" ]\n}\n")?;
    Ok(plugins)
}

/// Puts the add-on for Blender in place, with the plugin inside.
fn lay_out_add_on(plugins: &Path) -> Result<PathBuf> {
    let add_on = workspace::target().join("hydra/blender/umber");
    if add_on.exists() {
        fs::remove_dir_all(&add_on).with_context(|| add_on.display().to_string())?;
    }
    copy_folder(&workspace::root().join("plugInfo/blender/umber"), &add_on)?;
    copy_folder(plugins, &add_on.join("plugin"))?;
    for license in ["LICENSE-APACHE", "LICENSE-MIT"] {
        fs::copy(workspace::root().join(license), add_on.join(license)).context(license)?;
    }
    let manifest = add_on.join("blender_manifest.toml");
    let content = fs::read_to_string(&manifest).with_context(|| manifest.display().to_string())?;
    fs::write(&manifest, format!("platforms = [\"{}\"]\n{content}", platform(OS, ARCH)))?;
    Ok(add_on)
}

/// A platform as Blender's manifests name it: the renderer inside is built for one alone.
fn platform(system: &str, processor: &str) -> String {
    let processor = match processor {
        "x86_64" => "x64",
        "aarch64" => "arm64",
        other => other,
    };
    format!("{system}-{processor}")
}

/// Copies a folder with all that is in it, but for what Python compiled.
fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let (from, to) = entry.map(|entry| (entry.path(), to.join(entry.file_name())))?;
        if from.ends_with("__pycache__") {
            continue;
        }
        if from.is_dir() {
            copy_folder(&from, &to)?;
        } else {
            fs::copy(&from, &to).with_context(|| from.display().to_string())?;
        }
    }
    Ok(())
}

/// Writes a file in one step, so that nobody reads half of it; leaves it where it is the same.
fn replace(file: &Path, content: &[u8]) -> Result<()> {
    if fs::read(file).is_ok_and(|old| old == content) {
        return Ok(());
    }
    let draft = file.with_extension("new");
    fs::write(&draft, content).with_context(|| draft.display().to_string())?;
    fs::rename(&draft, file).with_context(|| file.display().to_string())
}

#[cfg(test)]
mod tests {
    use std::{env, fs, process};

    use super::{built_library, copy_folder, platform};

    #[test]
    fn platforms_are_named_as_blender_does() {
        assert_eq!(platform("linux", "x86_64"), "linux-x64");
        assert_eq!(platform("macos", "aarch64"), "macos-arm64");
    }

    #[test]
    fn folders_are_copied_without_what_python_compiled() {
        let folder = env::temp_dir().join(format!("umber-copy-{}", process::id()));
        let [from, to] = ["from", "to"].map(|name| folder.join(name));
        fs::create_dir_all(from.join("inner/__pycache__")).unwrap();
        fs::write(from.join("inner/a.py"), "a").unwrap();
        fs::write(from.join("inner/__pycache__/a.pyc"), "b").unwrap();
        copy_folder(&from, &to).unwrap();
        assert_eq!(fs::read_to_string(to.join("inner/a.py")).unwrap(), "a");
        assert!(!to.join("inner/__pycache__").exists());
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn shared_library_is_found_in_messages() {
        let dll = format!("/t/libx.{}", std::env::consts::DLL_EXTENSION);
        let message = format!(
            r#"{{"reason":"compiler-artifact","target":{{"kind":["cdylib"]}},"filenames":["/t/x.rlib","{dll}"]}}"#
        );
        let messages = format!("{{\"reason\":\"build-script-executed\"}}\n{message}\nnot json\n");
        assert_eq!(built_library(&messages).unwrap(), std::path::Path::new(&dll));
        assert!(built_library("").is_err());
    }
}
