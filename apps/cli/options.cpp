#include "options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <regex>

#include "base/error.h"
#include "base/text.h"
#include "flags.h"
#include "formats/formats.h"
#include "render_options.h"

namespace etendue {
namespace {

constexpr const char* kVersion = "etendue " ETENDUE_VERSION "\n";
constexpr const char* kExitCodes =
    "Exit codes:\n"
    "  0    done\n"
    "  1    internal error: please report it\n"
    "  2    the command line is wrong\n"
    "  3    an input file is missing or wrong\n"
    "  4    an output file cannot be written\n"
    "  5    diff: the error is above --fail-above\n"
    "  130  interrupted by Ctrl-C, SIGTERM or SIGHUP; what was rendered so far is written";

/// CLI11's help with usage lines of our own and descriptions broken into lines.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_usage(const CLI::App* app, std::string name) const override {
    const std::string& command = app->get_name();
    const std::string arguments = command == "render"    ? " SCENE -o FILE [OPTIONS]"
                                  : command == "info"    ? " SCENE [OPTIONS]"
                                  : command == "convert" ? " SCENE OUT.xml [OPTIONS]"
                                  : command == "envmap"  ? " FILE [OPTIONS]"
                                  : command == "diff"    ? " A B [OPTIONS]"
                                  : command == "help"    ? " [COMMAND]"
                                  : command == "version" ? ""
                                                         : " COMMAND [OPTIONS]";
    return fmt::format("\nUsage: {}{}\n\n", name, arguments);
  }

  std::string make_group(std::string group, bool positionals, std::vector<const CLI::Option*> options) const override {
    return CLI::Formatter::make_group(group, positionals, options).substr(1);  // CLI11 puts two empty lines before it
  }

  std::string make_positionals(const CLI::App*) const override { return {}; }  // the usage line names them

  std::string make_option_desc(const CLI::Option* option) const override {
    static constexpr std::size_t kWidth = 70;
    std::string text = option->get_description();
    for (std::size_t begin = 0; text.size() - begin > kWidth;) {
      const std::size_t space = text.rfind(' ', begin + kWidth);
      if (space == std::string::npos || space <= begin) break;
      text[space] = '\n';
      begin = space + 1;
    }
    return text;
  }
};

/// All commands, and where their words go.
struct Parser {
  Parser();
  CLI::App* add_command(const std::string& name, const std::string& about);
  CLI::App* add_working_command(const std::string& name, const std::string& about);

  CLI::App app{"Etendue renders scenes with physically based light transport."};
  bool quiet = false, verbose = false, version = false;
  RenderFlags render_flags;
  InfoOptions info_options;
  RenderFlags convert_flags;
  std::filesystem::path convert_output;
  EnvmapOptions envmap_options;
  DiffOptions diff_options;
  std::string help_topic;
  CLI::App *render, *info, *convert, *envmap, *diff, *help, *print_version;
};

CLI::App* Parser::add_command(const std::string& name, const std::string& about) {
  CLI::App* command = app.add_subcommand(name, about);
  command->allow_extras();
  return command;
}

/// A command that does something worth being told of.
CLI::App* Parser::add_working_command(const std::string& name, const std::string& about) {
  CLI::App* command = add_command(name, about);
  command->add_flag("-q,--quiet", quiet, "Print errors only")->group("Messages");
  command->add_flag("-v,--verbose", verbose, "Print more")->group("Messages");
  command->footer(kExitCodes);
  return command;
}

Parser::Parser() {
  app.name("etendue");
  app.formatter(std::make_shared<HelpFormatter>());
  app.require_subcommand(0, 1);
  app.allow_extras();
  app.add_flag("--version", version, "Print the version and exit");
  app.footer(std::string("etendue COMMAND --help explains a command's options.\n\n") + kExitCodes);

  render = add_working_command("render", "Render a picture of a scene");
  add_render_flags(*render, render_flags);

  info = add_working_command("info", "Say what a scene file holds");
  info->add_option("SCENE", info_options.scene, "The scene file");
  flags::definitions(*info, info_options.read.definitions, "Give $NAME of a Mitsuba scene this value");
  info->add_flag("--json", info_options.json, "As JSON");

  convert =
      add_working_command("convert",
                          "Write a scene as a Mitsuba 3 scene, with the camera that a render would use. Meshes and\n"
                          "volumes go into the folder OUT_files beside OUT.xml; pictures stay where they are and\n"
                          "are referred to");
  add_convert_flags(*convert, convert_flags);
  convert->add_option("OUT", convert_output, "The scene to write: .xml");

  envmap = add_working_command("envmap", "Say what light an environment map holds");
  envmap->add_option("FILE", envmap_options.file, "The latitude-longitude map");
  flags::file(*envmap, "--debug", envmap_options.debug,
              "Write the map's own cumulative distributions: red of the rows, green of the columns in their row");
  flags::file(
      *envmap, "--pdf", envmap_options.pdf,
      "Write the density per steradian that renders sample directions with (.exr); they interpolate the map, so "
      "that each of its rows lies between two of the map's");

  diff = add_working_command("diff", "Compare two pictures");
  diff->add_option("A", diff_options.a, "The picture");
  diff->add_option("B", diff_options.b, "The picture it is measured against");
  diff->add_flag("--variance", diff_options.variance, "Weigh the differences by the pictures' own variances");
  flags::file(*diff, "--heatmap", diff_options.heatmap, "Write where they differ (.png)");
  flags::number(*diff, "--fail-above", diff_options.fail_above, flags::Range{0.0, 1e30}, "RELMSE",
                "Exit with 5 if the relative mean squared error is above this");

  help = add_command("help", "Explain a command");
  help->add_option("COMMAND", help_topic, "The command");
  print_version = add_command("version", "Print the version");
}

[[noreturn]] void fail(const std::string& message) {
  throw Error(Failure::usage, message);
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
  const std::vector<std::string_view> views(candidates.begin(), candidates.end());
  const auto nearest = nearest_word(word, views);
  return nearest ? fmt::format("; did you mean {}?", *nearest) : "";
}

/// "etendue" or "etendue render".
std::string full_name(const CLI::App& command) {
  return command.get_parent() ? "etendue " + command.get_name() : "etendue";
}

[[noreturn]] void reject_option(const CLI::App& command, std::string_view word) {
  const std::string_view name = word.substr(0, word.find('='));
  std::vector<std::string> candidates;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& long_name : option->get_lnames()) candidates.push_back("--" + long_name);
  fail(fmt::format(
      "unknown option {}{}", name,
      name.starts_with("--") ? did_you_mean(name, candidates) : fmt::format("; see {} --help", full_name(command))));
}

/// Words that no option or positional of the command took.
void reject_remaining(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  for (const std::string& word : words)
    if (word.size() > 1 && word.starts_with('-')) reject_option(command, word);
  if (!words.empty()) fail(fmt::format("\"{}\" is one argument too many for etendue {}", words[0], command.get_name()));
}

bool looks_like_scene(const std::filesystem::path& word) {
  std::string extension = word.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::any_of(scene_formats(), [&](const SceneFormat& format) {
    return std::ranges::find(format.extensions, extension) != format.extensions.end();
  });
}

/// "; did you mean …?" for what was meant to be a command; empty if nothing is near.
std::string nearest_command(const Parser& parser, std::string_view word) {
  std::vector<std::string> names;
  for (const CLI::App* command : parser.app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return did_you_mean(word, names);
}

[[noreturn]] void reject_command(const Parser& parser, std::string_view word) {
  const std::string hint = nearest_command(parser, word);
  fail(fmt::format("unknown command \"{}\"{}", word, hint.empty() ? "; see etendue --help" : hint));
}

[[noreturn]] void reject_missing_command(const Parser& parser) {
  const std::vector<std::string> words = parser.app.remaining();
  if (words.empty()) fail("no command given: render, info, convert, envmap or diff; see etendue --help");
  const auto scene = std::ranges::find_if(words, looks_like_scene);
  const bool is_option = words[0].starts_with('-');
  if (scene != words.end() && (is_option || nearest_command(parser, words[0]).empty()))
    fail(fmt::format("no command given; did you mean etendue render {}?", *scene));
  if (is_option) reject_option(parser.app, words[0]);
  reject_command(parser, words[0]);
}

/// An option that lacks some of its words: "--resolution needs W H".
std::string missing_words(const Parser& parser, const std::string& cli11_message) {
  const std::string name = cli11_message.substr(0, cli11_message.find(':'));
  for (const CLI::App* command : parser.app.get_subcommands())
    if (const CLI::Option* option = command->get_option_no_throw(name))
      return fmt::format("{} needs {}", name, option->get_type_name());
  return cli11_message;
}

/// As a shell would take it.
std::string quoted(std::string_view word) {
  if (!word.empty() && word.find_first_of(" \t\n\"'\\$&;|<>()*?[]#~`!{}") == std::string_view::npos)
    return std::string(word);
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

std::string joined(int argc, const char* const* argv) {
  std::string text = "etendue";
  for (int i = 1; i < argc; ++i) text += " " + quoted(argv[i]);
  return text;
}

/// What `etendue help [COMMAND]` prints.
std::string help_text(const Parser& p) {
  const auto help_of = [](const CLI::App& command) {
    return command.get_formatter()->make_help(&command, full_name(command), CLI::AppFormatMode::Normal);
  };
  if (p.help_topic.empty()) return help_of(p.app);
  const auto named =
      p.app.get_subcommands([&](const CLI::App* command) { return command->get_name() == p.help_topic; });
  if (named.empty()) reject_command(p, p.help_topic);
  return help_of(*named.front());
}

/// The words behind the program's name, where WxH has become two.
std::vector<std::string> words_of(int argc, const char* const* argv) {
  static const std::regex kSize("(--resolution=)?([0-9]+)[xX]([0-9]+)");
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool expected = !words.empty() && (words.back() == "-r" || words.back() == "--resolution");
    std::smatch size;
    if (std::regex_match(word, size, kSize) && size[1].matched != expected) {
      if (!expected) words.push_back("--resolution");
      words.insert(words.end(), {size[2], size[3]});
    } else {
      words.push_back(word);
    }
  }
  return words;
}

void require(bool given, const char* message) {
  if (!given) fail(message);
}

CommandLine parsed(const Parser& p, std::string command_line) {
  if (p.version) return {LogLevel::normal, PrintText{kVersion}};
  if (p.app.get_subcommands().empty()) reject_missing_command(p);
  const CLI::App* command = p.app.get_subcommands().front();
  if (const std::vector<std::string> early = p.app.remaining(); !early.empty())
    fail(fmt::format("{} stands before the command; options stand behind it: etendue {} … {}", early[0],
                     command->get_name(), early[0]));
  reject_remaining(*command);
  if (command == p.help) return {LogLevel::normal, PrintText{help_text(p)}};
  if (command == p.print_version) return {LogLevel::normal, PrintText{kVersion}};
  if (p.quiet && p.verbose) fail("--quiet and --verbose contradict each other; give one of them");
  if (p.quiet && p.render_flags.options.preview) fail("--quiet and --preview contradict each other; give one of them");

  CommandLine line;
  line.log_level = p.quiet ? LogLevel::quiet : p.verbose ? LogLevel::verbose : LogLevel::normal;
  if (command == p.render) {
    RenderOptions options = settled(p.render_flags);
    options.command_line = std::move(command_line);
    options.quiet = p.quiet;
    line.command = std::move(options);
  } else if (command == p.info) {
    require(!p.info_options.scene.empty(), "info needs a scene: etendue info SCENE");
    line.command = p.info_options;
  } else if (command == p.convert) {
    require(!p.convert_output.empty(), "convert needs a scene and a place for it: etendue convert SCENE OUT.xml");
    RenderFlags flags = p.convert_flags;
    flags.options.outputs = {p.convert_output};
    line.command = ConvertOptions{settled(flags), p.convert_output};
  } else if (command == p.envmap) {
    require(!p.envmap_options.file.empty(), "envmap needs a map: etendue envmap FILE");
    line.command = p.envmap_options;
  } else {
    require(!p.diff_options.b.empty(), "diff needs two pictures: etendue diff A B");
    line.command = p.diff_options;
  }
  return line;
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  Parser parser;
  try {
    std::vector<std::string> words = words_of(argc, argv);
    std::ranges::reverse(words);  // as CLI11 wants them
    parser.app.parse(words);
  } catch (const CLI::CallForHelp&) {
    return {LogLevel::normal, PrintText{parser.app.help()}};
  } catch (const CLI::ArgumentMismatch& error) {
    fail(missing_words(parser, error.what()));
  } catch (const CLI::ParseError& error) {
    fail(error.what());
  }
  return parsed(parser, joined(argc, argv));
}

}  // namespace etendue
