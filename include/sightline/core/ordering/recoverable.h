#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sightline::core {

struct RecoverableParams {
  std::size_t most_messages = 512;  ///< that are handled again after a throw, >= 1
  std::size_t most_size = 16384;    ///< of all of them together
};

/// A state that survives a message whose handling throws: it is then what it was before that message, to the
/// last bit. A copy of the state is kept now and then, with the messages since; after a throw the copy is
/// taken and those messages are handled again, as they have been before without a throw.
///
/// `State` is copied; copies are independent, and the same messages bring equal copies to equal states.
template <typename State, typename Message, typename Answer>
class Recoverable {
 public:
  /// Handles a message; may throw.
  using Handle = std::function<Answer(State&, const Message&)>;
  /// Size of a message, for the bound on what is kept.
  using Size = std::function<std::size_t(const Message&)>;

  Recoverable(State state, Handle handle, Size size, const RecoverableParams& params = {})
      : handle_(std::move(handle)),
        size_(std::move(size)),
        params_(params),
        state_(std::make_unique<State>(std::move(state))) {
    keep();
  }

  /// The answer to a message; nullopt when its handling threw (`failure`), and the message changed nothing.
  std::optional<Answer> take(Message message) {
    try {
      Answer answer = handle_(*state_, message);
      remember(std::move(message));
      failures_in_a_row_ = 0;
      return answer;
    } catch (const std::exception& problem) {
      failure_ = problem.what();
    } catch (...) {
      failure_ = "an exception of an unknown kind";
    }
    ++failures_in_a_row_;
    goBack();
    return std::nullopt;
  }

  const State& state() const { return *state_; }

  /// Changes the state by something that is no message.
  template <typename Change>
  void change(const Change& change) {
    change(*state_);
    keep();
  }

  /// Why the last message that failed did.
  const std::string& failure() const { return failure_; }

  /// Messages that failed since the last one that did not.
  std::size_t failuresInARow() const { return failures_in_a_row_; }

 private:
  void keep() {
    kept_ = std::make_unique<const State>(*state_);
    since_.clear();
    size_since_ = 0;
  }

  void remember(Message message) {
    size_since_ += size_(message);
    if (since_.size() + 1 >= params_.most_messages || size_since_ > params_.most_size) return keep();
    since_.push_back(std::move(message));
  }

  void goBack() {
    state_ = std::make_unique<State>(*kept_);
    for (const Message& message : since_) handle_(*state_, message);
    if (!since_.empty()) keep();
  }

  Handle handle_;
  Size size_;
  RecoverableParams params_;
  std::unique_ptr<State> state_;
  std::unique_ptr<const State> kept_;
  std::vector<Message> since_;  // handled since `kept_`
  std::size_t size_since_ = 0;
  std::string failure_;
  std::size_t failures_in_a_row_ = 0;
};

}  // namespace sightline::core
