#include "pipeline/scene/urdf.hpp"

#include <tinyxml2.h>

#include <cmath>
#include <map>
#include <memory>

#include "geometry/text.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using tinyxml2::XMLElement;

constexpr double kMostLength = 1e6;  // m

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file) {}

  Urdf read(std::string_view text) {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
      const std::string why = document.ErrorName();
      fail(std::max(1, document.ErrorLineNum()), "is no well-formed XML (" + why + ")");
    }
    const XMLElement* robot = document.RootElement();
    if (!robot || std::string_view(robot->Name()) != "robot")
      fail(robot ? robot->GetLineNum() : 1,
           "must begin with <robot>" + (robot ? ", not <" + one_line(robot->Name()) + ">" : std::string()));
    refuse_xacro(*robot);
    if (const char* name = robot->Attribute("name")) out_.name = name;
    for (const XMLElement* link = robot->FirstChildElement("link"); link; link = link->NextSiblingElement("link"))
      read_link(*link);
    if (out_.links.empty()) fail(robot->GetLineNum(), "has no link");
    for (const XMLElement* joint = robot->FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint"))
      read_joint(*joint);
    find_mimics(*robot);
    order();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    throw Error(kInput, file_ + ":" + std::to_string(line) + ": " + what);
  }

  void refuse_xacro(const XMLElement& robot) const {
    for (const XMLElement* e = robot.FirstChildElement(); e; e = e->NextSiblingElement())
      if (std::string_view(e->Name()).starts_with("xacro:"))
        fail(e->GetLineNum(), "is xacro; expand it first: xacro FILE > robot.urdf");
  }

  std::string text(const XMLElement& e, const char* name) const {
    const char* value = e.Attribute(name);
    if (!value || !*value) fail(e.GetLineNum(), "<" + std::string(e.Name()) + "> must have '" + name + "'");
    return value;
  }

  /// As many numbers as there are places.
  template <std::size_t N>
  std::array<double, N> numbers(const XMLElement& e, const char* name, double most) const {
    const std::string written = text(e, name);
    std::array<double, N> out{};
    std::string_view rest = written;
    constexpr std::string_view kBlank = " \t\r\n";
    std::size_t count = 0;
    for (; !rest.empty(); ++count) {
      rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
      if (rest.empty()) break;
      const std::size_t end = std::min(rest.find_first_of(kBlank), rest.size());
      double value = 0;
      const auto [stop, error] = geometry::nearest_double(rest.data(), rest.data() + end, value);
      if (error != std::errc() || stop != rest.data() + end || !(std::abs(value) <= most) || count == N)
        wrong(e, name, written, N, most);
      out[count] = value;
      rest.remove_prefix(end);
    }
    if (count != N) wrong(e, name, written, N, most);
    return out;
  }

  [[noreturn]] void wrong(const XMLElement& e, const char* name, const std::string& written, std::size_t n,
                          double most) const {
    fail(e.GetLineNum(), "'" + std::string(name) + "' of <" + e.Name() + "> must be " + std::to_string(n) +
                             (n == 1 ? " number" : " numbers") + " of at most " + real_text(most) + ", not " +
                             in_quotes(one_line(written)));
  }

  double positive(const XMLElement& e, const char* name) const {
    const double value = numbers<1>(e, name, kMostLength)[0];
    if (!(value > 0)) fail(e.GetLineNum(), "'" + std::string(name) + "' of <" + e.Name() + "> must be above 0");
    return value;
  }

  geometry::Pose origin(const XMLElement& of) const {
    geometry::Pose pose;
    const XMLElement* e = of.FirstChildElement("origin");
    if (!e) return pose;
    if (e->Attribute("xyz")) {
      const auto p = numbers<3>(*e, "xyz", kMostLength);
      pose.t = {p[0], p[1], p[2]};
    }
    if (e->Attribute("rpy")) {  // about fixed axes: x, then y, then z
      const auto a = numbers<3>(*e, "rpy", 1e6);
      using geometry::turn_about;
      using geometry::Vec3;
      pose.q = geometry::normalised(turn_about(Vec3::UnitZ(), a[2]) *
                                    (turn_about(Vec3::UnitY(), a[1]) * turn_about(Vec3::UnitX(), a[0])));
    }
    return pose;
  }

  void read_link(const XMLElement& e) {
    UrdfLink link{.name = text(e, "name"), .collisions = {}, .line = e.GetLineNum()};
    if (!links_.emplace(link.name, out_.links.size()).second)
      fail(link.line, "a second link is named " + in_quotes(one_line(link.name)));
    for (const XMLElement* c = e.FirstChildElement("collision"); c; c = c->NextSiblingElement("collision")) {
      const XMLElement* geometry = c->FirstChildElement("geometry");
      const XMLElement* shape = geometry ? geometry->FirstChildElement() : nullptr;
      if (!shape) fail(c->GetLineNum(), "<collision> must have a <geometry> with a shape");
      link.collisions.push_back(read_shape(*shape, origin(*c)));
    }
    out_.links.push_back(std::move(link));
  }

  UrdfCollision read_shape(const XMLElement& e, const geometry::Pose& origin) const {
    UrdfCollision out;
    out.origin = origin;
    out.line = e.GetLineNum();
    const std::string_view kind = e.Name();
    if (kind == "mesh") {
      out.file = text(e, "filename");
      if (e.Attribute("scale")) out.scale = numbers<3>(e, "scale", 1e9);
      for (const double s : out.scale)
        if (!(s > 0))
          fail(out.line, "'scale' of <mesh> must be three numbers above 0, not " +
                             in_quotes(one_line(text(e, "scale"))) +
                             (s < 0 ? "; a mirrored mesh has to be made as such" : ""));
    } else if (kind == "box") {
      out.kind = UrdfCollision::box;
      const auto size = numbers<3>(e, "size", kMostLength);
      for (const double s : size)
        if (!(s > 0)) fail(out.line, "'size' of <box> must be three numbers above 0");
      out.size = {size[0], size[1], size[2]};
    } else if (kind == "sphere") {
      out.kind = UrdfCollision::sphere;
      out.radius = positive(e, "radius");
    } else if (kind == "cylinder") {
      out.kind = UrdfCollision::cylinder;
      out.radius = positive(e, "radius");
      out.length = positive(e, "length");
    } else {
      fail(out.line, "<" + one_line(e.Name()) + "> is no shape of URDF; mesh, box, sphere and cylinder are");
    }
    return out;
  }

  std::size_t link(const XMLElement& joint, const char* role) const {
    const XMLElement* e = joint.FirstChildElement(role);
    if (!e) fail(joint.GetLineNum(), "<joint> must have a <" + std::string(role) + ">");
    const std::string name = text(*e, "link");
    const auto found = links_.find(name);
    if (found == links_.end()) fail(e->GetLineNum(), "there is no link " + in_quotes(one_line(name)));
    return found->second;
  }

  void read_joint(const XMLElement& e) {
    UrdfJoint joint;
    joint.name = text(e, "name");
    joint.type = text(e, "type");
    joint.line = e.GetLineNum();
    if (!joints_.emplace(joint.name, out_.joints.size()).second)
      fail(joint.line, "a second joint is named " + in_quotes(one_line(joint.name)));
    if (joint.type == "revolute" || joint.type == "continuous")
      joint.kind = UrdfJoint::turning;
    else if (joint.type == "prismatic")
      joint.kind = UrdfJoint::sliding;
    else if (joint.type != "fixed")
      fail(joint.line, "joint " + in_quotes(one_line(joint.name)) +
                           " must be revolute, continuous, prismatic or fixed, not " + in_quotes(one_line(joint.type)));
    joint.above = link(e, "parent");
    joint.below = link(e, "child");
    joint.origin = origin(e);
    if (const XMLElement* axis = e.FirstChildElement("axis")) {
      const auto a = numbers<3>(*axis, "xyz", 1e6);
      joint.axis = {a[0], a[1], a[2]};
      if (joint.kind != UrdfJoint::fixed && !(joint.axis.norm() > 1e-9))
        fail(axis->GetLineNum(), "the axis must not be 0");
    }
    const XMLElement* limit = e.FirstChildElement("limit");
    if (limit && joint.type != "continuous" && joint.kind != UrdfJoint::fixed) {
      joint.limits = {0, 0};
      if (limit->Attribute("lower")) (*joint.limits)[0] = numbers<1>(*limit, "lower", 1e300)[0];
      if (limit->Attribute("upper")) (*joint.limits)[1] = numbers<1>(*limit, "upper", 1e300)[0];
      if ((*joint.limits)[0] > (*joint.limits)[1]) fail(limit->GetLineNum(), "'lower' of <limit> is above 'upper'");
    }
    UrdfLink& below = out_.links[joint.below];
    if (below.joint != std::size_t(-1))
      fail(joint.line, "link " + in_quotes(one_line(below.name)) + " hangs on two joints, " +
                           in_quotes(one_line(out_.joints[below.joint].name)) + " and " +
                           in_quotes(one_line(joint.name)) + "; a robot is a tree");
    below.joint = out_.joints.size();
    out_.joints.push_back(std::move(joint));
  }

  void find_mimics(const XMLElement& robot) {
    std::size_t at = 0;
    for (const XMLElement* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint"), ++at) {
      const XMLElement* m = e->FirstChildElement("mimic");
      if (!m || out_.joints[at].kind == UrdfJoint::fixed) continue;
      const std::string name = text(*m, "joint");
      const auto found = joints_.find(name);
      if (found == joints_.end()) fail(m->GetLineNum(), "there is no joint " + in_quotes(one_line(name)));
      UrdfJoint::Mimic mimic{.joint = found->second};
      if (m->Attribute("multiplier")) mimic.multiplier = numbers<1>(*m, "multiplier", 1e9)[0];
      if (m->Attribute("offset")) mimic.offset = numbers<1>(*m, "offset", 1e9)[0];
      out_.joints[at].mimic = mimic;
    }
    for (const UrdfJoint& joint : out_.joints)
      if (joint.mimic &&
          (out_.joints[joint.mimic->joint].mimic || out_.joints[joint.mimic->joint].kind == UrdfJoint::fixed))
        fail(joint.line, "joint " + in_quotes(one_line(joint.name)) + " follows one that has no value of its own");
  }

  /// From the root outwards; what is not reached hangs on itself.
  void order() {
    std::vector<std::vector<std::size_t>> under(out_.links.size());
    for (const UrdfJoint& joint : out_.joints) under[joint.above].push_back(joint.below);
    std::vector<bool> reached(out_.links.size());
    for (std::size_t i = 0; i < out_.links.size(); ++i) {
      if (out_.links[i].joint != std::size_t(-1)) continue;
      if (!out_.order.empty())
        fail(out_.links[i].line, "links " + in_quotes(one_line(out_.links[out_.order[0]].name)) + " and " +
                                     in_quotes(one_line(out_.links[i].name)) +
                                     " both hang on nothing; one link is the root");
      out_.order.push_back(i);
      reached[i] = true;
    }
    for (std::size_t k = 0; k < out_.order.size(); ++k)
      for (const std::size_t below : under[out_.order[k]]) {
        out_.order.push_back(below);
        reached[below] = true;
      }
    for (std::size_t i = 0; i < out_.links.size(); ++i)
      if (!reached[i])
        fail(out_.joints[out_.links[i].joint].line,
             "link " + in_quotes(one_line(out_.links[i].name)) + " hangs on itself: the joints make a circle");
  }

  std::string file_;
  Urdf out_;
  std::map<std::string, std::size_t> links_, joints_;
};

}  // namespace

Urdf parse_urdf(std::string_view text, const std::string& file) { return Reader(file).read(text); }

}  // namespace pipeline
